#include "optimisers.h"

#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "mesh/errors.h"

#ifdef PALPATE_WITH_NLOPT
#include <nlopt.hpp>
#endif

namespace palpate::bench {

using identify::PositionDomain;

namespace {

/// Modelled less measured markers, of one set.
struct Residuals {
    using Scalar = double;
    using InputType = Eigen::VectorXd;
    using ValueType = Eigen::VectorXd;
    using JacobianType = Eigen::MatrixXd;
    enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

    const PositionDomain* domain;
    int inputs() const { return domain->parameters().size(); }
    int values() const {
        int rows = 0;
        for (const identify::StateReadings& state : domain->states()) rows += static_cast<int>(3 * state.rest.rows());
        return rows;
    }
    int operator()(const Eigen::VectorXd& theta, Eigen::VectorXd& r) const {
        try {
            const identify::Prediction prediction = domain->predict(theta, 1);
            Eigen::Index row = 0;
            for (std::size_t s = 0; s < domain->states().size(); ++s) {
                const Points off = prediction.markers[s] - domain->states()[s].measured;
                r.segment(row, off.size()) = off.reshaped<Eigen::RowMajor>();
                row += off.size();
            }
        } catch (const SolverFailure&) {
            r.setConstant(1e3);
        }
        return 0;
    }
};

}  // namespace

Eigen::VectorXd levenberg_marquardt(const PositionDomain& domain) {
    Eigen::NumericalDiff<Residuals> residuals(Residuals{&domain}, 1e-12);
    Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Residuals>> lm(residuals);
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(domain.parameters().size());
    lm.minimize(theta);
    return theta;
}

#ifdef PALPATE_WITH_NLOPT
Eigen::VectorXd controlled_random_search(const PositionDomain& domain) {
    const auto n = static_cast<unsigned>(domain.parameters().size());
    nlopt::opt search(nlopt::GN_CRS2_LM, n);
    search.set_lower_bounds(std::log(0.05));
    search.set_upper_bounds(std::log(2));
    search.set_ftol_rel(1e-6);
    search.set_maxeval(3000);
    search.set_min_objective(
        [](unsigned count, const double* x, double*, void* data) {
            const auto& d = *static_cast<const PositionDomain*>(data);
            try {
                return d.squared_distance(d.predict(Eigen::Map<const Eigen::VectorXd>(x, count), 1));
            } catch (const SolverFailure&) {
                return 1e9;
            }
        },
        const_cast<PositionDomain*>(&domain));
    std::vector<double> x(n, 0);
    double least = 0;
    search.optimize(x, least);
    return Eigen::Map<Eigen::VectorXd>(x.data(), n);
}
#endif

}  // namespace palpate::bench
