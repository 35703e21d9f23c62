#include <algorithm>
#include <optional>

#include "identify/fit/position_domain.h"
#include "identify/parallel.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr int batch = 8;             // states whose parts are held at once, whatever the threads
constexpr Eigen::Index strip = 128;  // rows of H that are made at once, and stay in the cache

/// Adds to rows begin .. begin + strip of H, not above the diagonal, those of factor G^T S G.
/// S: symmetric (n x n), G: sparse (n x P).
void add_congruence(double factor, const Eigen::MatrixXd& S, const Eigen::SparseMatrix<double>& G, Eigen::Index begin,
                    Eigen::MatrixXd& H) {
    using Entry = Eigen::SparseMatrix<double>::InnerIterator;
    const Eigen::Index end = std::min(begin + strip, G.cols());
    // rows of G^T S
    Eigen::MatrixXd SG = Eigen::MatrixXd::Zero(S.rows(), end - begin);
    for (Eigen::Index p = begin; p < end; ++p) {
        for (Entry g(G, p); g; ++g) SG.col(p - begin) += factor * g.value() * S.col(g.row());
    }
    const Eigen::MatrixXd GS = SG.transpose();
    // times the columns of G
    for (Eigen::Index p = 0; p < end; ++p) {
        const Eigen::Index first = std::max(begin, p), count = end - first;
        for (Entry g(G, p); g; ++g) H.col(p).segment(first, count) += g.value() * GS.col(g.row()).tail(count);
    }
}

/// What a state adds to H: ratio G^T S G, or J^T W J itself where parameters are few and S is not there.
struct Part {
    Eigen::SparseMatrix<double> G;             // dr/dtheta (6N x P)
    std::shared_ptr<const Eigen::MatrixXd> S;  // of the pull-back (6N x 6N)
    double ratio = 1;
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
};

}  // namespace

Eigen::MatrixXd PositionDomain::from_the_right(int s, const Eigen::SparseMatrix<double>& G_theta,
                                               const Prediction& prediction,
                                               const skeleton::StaticsSolver& solver) const {
    const Eigen::MatrixXd J = observation(s, prediction) * solver.solve_tangent(Eigen::MatrixXd(G_theta));
    return J.transpose() * weights_[s].asDiagonal() * J;
}

Eigen::MatrixXd PositionDomain::pull_back(int s, const Prediction& prediction,
                                          const skeleton::StaticsSolver& solver) const {
    const Eigen::SparseMatrix<double> P = observation(s, prediction);
    if (P.rows() < P.cols()) {
        const Eigen::MatrixXd X = solver.solve_tangent(Eigen::MatrixXd(P.transpose()));
        return X * weights_[s].asDiagonal() * X.transpose();
    }
    const Eigen::SparseMatrix<double> PWP = P.transpose() * weights_[s].asDiagonal() * P;
    return solver.solve_tangent(solver.solve_tangent(Eigen::MatrixXd(PWP)).transpose());
}

/// By the linear law states with the same markers share a pull-back but for one factor, where their weights do.
std::optional<double> PositionDomain::weight_ratio(int s, int other) const {
    if (s == other) return 1;
    if (law() != skeleton::Law::linear || states_[s].markers != states_[other].markers) return std::nullopt;
    const double ratio = weights_[s].sum() / weights_[other].sum();
    if (!weights_[s].isApprox(ratio * weights_[other], 1e-12)) return std::nullopt;
    return ratio;
}

NormalEquations PositionDomain::normal_equations(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const Eigen::SparseMatrix<double> dk = parameters_.derivative(k);
    const int P = parameters_.size(), states = static_cast<int>(states_.size());
    NormalEquations sum{Eigen::MatrixXd::Zero(P, P), Eigen::VectorXd::Zero(P)};

    // the linear law has one tangent for all states
    const SolverPool::Loan shared(*solvers_);
    const bool linear = law() == skeleton::Law::linear;
    if (linear) shared->factor_tangent(k, states_[0].load, prediction.equilibria[0]);

    // and states that read the same markers share the way back
    std::shared_ptr<const Eigen::MatrixXd> common;
    if (linear && P > 3 * states_[0].rest.rows()) {
        common = std::make_shared<const Eigen::MatrixXd>(pull_back(0, prediction, *shared));
    }

    for (int first = 0; first < states; first += batch) {
        std::vector<Part> parts(std::min(batch, states - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int i) {
            const int s = first + i;
            Part& part = parts[i];
            part.G = skeleton::link_forces(*model_, prediction.equilibria[s]) * dk;
            const SolverPool::Loan own(*solvers_);
            if (!linear) own->factor_tangent(k, states_[s].load, prediction.equilibria[s]);
            const skeleton::StaticsSolver& solver = linear ? *shared : *own;
            // J^T d, J = -P T^-1 G
            const Eigen::VectorXd error = weights_[s].cwiseProduct(errors(s, prediction.markers[s]));
            part.g = -part.G.transpose() *
                     solver.solve_tangent(Eigen::VectorXd(observation(s, prediction).transpose() * error)).col(0);
            if (P <= 3 * states_[s].rest.rows()) {
                part.H = from_the_right(s, part.G, prediction, solver);
            } else if (const auto ratio = common ? weight_ratio(s, 0) : std::nullopt) {
                part.S = common;
                part.ratio = *ratio;
            } else {
                part.S = std::make_shared<const Eigen::MatrixXd>(pull_back(s, prediction, solver));
            }
        });
        for (const Part& part : parts) {
            sum.g += part.g;
            if (!part.S) sum.H += part.H;
        }
        for_each_in_parallel(static_cast<int>((P + strip - 1) / strip), threads_, [&](int i) {
            for (const Part& part : parts) {
                if (part.S) add_congruence(part.ratio, *part.S, part.G, i * strip, sum.H);
            }
        });
    }
    sum.H.triangularView<Eigen::StrictlyUpper>() = sum.H.transpose();
    return sum;
}

}  // namespace palpate::identify
