#include <algorithm>
#include <optional>

#include "identify/fit/position_domain.h"
#include "identify/parallel.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr int batch = 8;  // states whose normal equations are held at once, whatever the threads

/// Adds the lower half of factor G^T S G, of a symmetric S (n x n) and a sparse G (n x P), by strips that stay in the
/// cache.
void add_congruence(double factor, const Eigen::MatrixXd& S, const Eigen::SparseMatrix<double>& G, Eigen::MatrixXd& H) {
    using Entry = Eigen::SparseMatrix<double>::InnerIterator;
    constexpr Eigen::Index width = 128;
    for (Eigen::Index begin = 0; begin < G.cols(); begin += width) {
        const Eigen::Index end = std::min(begin + width, G.cols());
        // rows begin..end of G^T S
        Eigen::MatrixXd SG = Eigen::MatrixXd::Zero(S.rows(), end - begin);
        for (Eigen::Index p = begin; p < end; ++p) {
            for (Entry g(G, p); g; ++g) SG.col(p - begin) += factor * g.value() * S.col(g.row());
        }
        const Eigen::MatrixXd GS = SG.transpose();
        // times the columns of G, not above the diagonal
        for (Eigen::Index p = 0; p < end; ++p) {
            const Eigen::Index first = std::max(begin, p), count = end - first;
            for (Entry g(G, p); g; ++g) H.col(p).segment(first, count) += g.value() * GS.col(g.row()).tail(count);
        }
    }
}

}  // namespace

NormalEquations PositionDomain::from_the_right(int s, const Eigen::SparseMatrix<double>& G_theta,
                                               const Prediction& prediction,
                                               const skeleton::StaticsSolver& solver) const {
    // J = P (T^-1 G_theta)
    const Eigen::MatrixXd J = observation(s, prediction) * solver.solve_tangent(Eigen::MatrixXd(G_theta));
    const Eigen::VectorXd error = errors(s, prediction.markers[s]);
    return {J.transpose() * weights_[s].asDiagonal() * J, -J.transpose() * weights_[s].cwiseProduct(error)};
}

PositionDomain::PullBack PositionDomain::pull_back(int s, const Prediction& prediction,
                                                   const skeleton::StaticsSolver& solver) const {
    PullBack result{s, solver.solve_tangent(Eigen::MatrixXd(observation(s, prediction).transpose())), {}};
    result.XWX.noalias() = result.X * (weights_[s].asDiagonal() * result.X.transpose());
    return result;
}

NormalEquations PositionDomain::from_the_left(int s, const Eigen::SparseMatrix<double>& G_theta,
                                              const Prediction& prediction, const PullBack& pull_back,
                                              double ratio) const {
    // J^T W J = G_theta^T (X W X^T) G_theta
    const Eigen::VectorXd error = errors(s, prediction.markers[s]);
    NormalEquations result{Eigen::MatrixXd::Zero(G_theta.cols(), G_theta.cols()), {}};
    add_congruence(ratio, pull_back.XWX, G_theta, result.H);
    result.g = -G_theta.transpose() * (pull_back.X * weights_[s].cwiseProduct(error));
    return result;
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
    std::optional<PullBack> common;
    if (linear && P > 3 * states_[0].rest.rows()) common = pull_back(0, prediction, *shared);

    for (int first = 0; first < states; first += batch) {
        std::vector<NormalEquations> parts(std::min(batch, states - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int i) {
            const int s = first + i;
            const Eigen::SparseMatrix<double> G_theta = skeleton::link_forces(*model_, prediction.equilibria[s]) * dk;
            const SolverPool::Loan own(*solvers_);
            if (!linear) own->factor_tangent(k, states_[s].load, prediction.equilibria[s]);
            const skeleton::StaticsSolver& solver = linear ? *shared : *own;
            if (P <= 3 * states_[s].rest.rows()) {
                parts[i] = from_the_right(s, G_theta, prediction, solver);
            } else if (const auto ratio = common ? weight_ratio(s, common->state) : std::nullopt) {
                parts[i] = from_the_left(s, G_theta, prediction, *common, *ratio);
            } else {
                parts[i] = from_the_left(s, G_theta, prediction, pull_back(s, prediction, solver), 1);
            }
        });
        for (const NormalEquations& part : parts) {
            sum.H += part.H;
            sum.g += part.g;
        }
    }
    sum.H.triangularView<Eigen::StrictlyUpper>() = sum.H.transpose();
    return sum;
}

}  // namespace palpate::identify
