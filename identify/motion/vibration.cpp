#include "identify/motion/vibration.h"

#include <fmt/format.h>

#include <Spectra/SymEigsSolver.h>
#include <Eigen/Cholesky>
#include <algorithm>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

using skeleton::Model;
using skeleton::State;
using Block6 = Eigen::Matrix<double, 6, 6>;

/// Mass and inertia of a sphere as it stands.
Block6 mass_of(const skeleton::Sphere& sphere, const Mat3& R) {
    Block6 M = Block6::Zero();
    M.topLeftCorner<3, 3>() = sphere.mass * Mat3::Identity();
    M.bottomRightCorner<3, 3>() = R * sphere.inertia * R.transpose();
    return M;
}

/// B = L^T J^-1 L of the tangent J and M = L L^T, whose largest eigenvalues are 1 / w^2: as Spectra wants it.
class Flexibility {
public:
    using Scalar = double;

    Flexibility(const Model& model, const skeleton::StaticsSolver& solver, const State& state) : solver_(solver) {
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            const skeleton::Sphere& sphere = model.spheres[i];
            const Eigen::LLT<Block6> root(mass_of(sphere, state.R[i]));
            if (!(sphere.mass > 0) || root.info() != Eigen::Success) {
                if (!sphere.held)
                    throw InvalidInput(
                        fmt::format("sphere {} moves and has no mass, or no inertia; motion needs one: "
                                    "give it a 'mass' above 0",
                                    i));
                roots_.emplace_back(Block6::Zero());
                continue;
            }
            roots_.emplace_back(root.matrixL());
            moving_ += sphere.held ? 0 : 1;
        }
    }

    Eigen::Index rows() const { return 6 * static_cast<Eigen::Index>(roots_.size()); }
    Eigen::Index cols() const { return rows(); }
    int moving() const { return moving_; }  // spheres

    void perform_op(const double* x, double* y) const {
        Eigen::Map<Eigen::VectorXd>(y, rows()) =
            left(solver_.solve_tangent(times(Eigen::Map<const Eigen::VectorXd>(x, rows()))));
    }

    /// J^-1 L x, the shapes that belong to eigenvectors but for a factor.
    Eigen::MatrixXd shapes(const Eigen::MatrixXd& x) const { return solver_.solve_tangent(times(x)); }

private:
    Eigen::MatrixXd times(const Eigen::MatrixXd& x) const {
        Eigen::MatrixXd y(x.rows(), x.cols());
        for (std::size_t i = 0; i < roots_.size(); ++i) {
            const auto row = 6 * static_cast<Eigen::Index>(i);
            y.middleRows<6>(row) = roots_[i] * x.middleRows<6>(row);
        }
        return y;
    }
    Eigen::VectorXd left(const Eigen::MatrixXd& x) const {
        Eigen::VectorXd y(x.rows());
        for (std::size_t i = 0; i < roots_.size(); ++i) {
            const auto row = 6 * static_cast<Eigen::Index>(i);
            y.segment<6>(row) = roots_[i].transpose() * x.col(0).segment<6>(row);
        }
        return y;
    }

    const skeleton::StaticsSolver& solver_;
    std::vector<Block6> roots_;  // L of each sphere
    int moving_ = 0;
};

}  // namespace

Eigen::MatrixXd times_mass(const Model& model, const State& state, const Eigen::MatrixXd& v) {
    Eigen::MatrixXd y(v.rows(), v.cols());
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const auto row = 6 * static_cast<Eigen::Index>(i);
        y.middleRows<6>(row) = mass_of(model.spheres[i], state.R[i]) * v.middleRows<6>(row);
    }
    return y;
}

Vibration vibration(const Model& model, const skeleton::StaticsSolver& solver, const State& state, int modes) {
    constexpr int iterations = 1000;    // restarts of Lanczos' method: a bound
    constexpr double tolerance = 1e-8;  // of eigenvalues
    Flexibility B(model, solver, state);
    const int most = 6 * B.moving();
    const int wanted = std::min(modes, most);
    if (wanted < 1) return {};
    // subspace of Lanczos' method: above the number that is sought, at most the matrix
    const int subspace = std::min(static_cast<int>(B.rows()), std::max(2 * wanted + 1, 20));
    Spectra::SymEigsSolver<Flexibility> lanczos(B, std::min(wanted, static_cast<int>(B.rows()) - 1), subspace);
    lanczos.init();
    lanczos.compute(Spectra::SortRule::LargestMagn, iterations, tolerance);
    if (lanczos.info() != Spectra::CompInfo::Successful)
        throw SolverFailure(
            fmt::format("the {} slowest vibrations were not found in {} iterations", wanted, iterations));
    Vibration found;
    found.frequencies = lanczos.eigenvalues().cwiseSqrt().cwiseInverse();
    // J^-1 L x = L^-T x / w^2, of x normed: as modes are with mass 1 after division by that
    found.shapes = B.shapes(lanczos.eigenvectors()) * found.frequencies.cwiseAbs2().asDiagonal();
    return found;
}

}  // namespace palpate::identify
