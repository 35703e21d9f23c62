#include "identify/fit/slopes.h"

#include <algorithm>
#include <functional>

#include "identify/fit/position_domain.h"
#include "identify/parallel.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr int batch = 8;  // states whose parts are held at once, whatever the threads

/// The sum of one part a state (P x n), in the states' order.
Eigen::MatrixXd sum_of_parts(int states, int threads, const std::function<Eigen::MatrixXd(int)>& part_of) {
    Eigen::MatrixXd sum;
    for (int first = 0; first < states; first += batch) {
        std::vector<Eigen::MatrixXd> parts(std::min(batch, states - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads, [&](int i) { parts[i] = part_of(first + i); });
        for (const Eigen::MatrixXd& part : parts) {
            if (sum.size() == 0) sum.setZero(part.rows(), part.cols());
            sum += part;
        }
    }
    return sum;
}

}  // namespace

Eigen::VectorXd Slopes::gradient() const {
    // J^T d = -G^T T^-1 P^T W (measured - modelled)
    return sum_of_parts(static_cast<int>(states_.size()), threads_, [&](int s) -> Eigen::MatrixXd {
        const State& state = states_[s];
        return -(state.G.transpose() * state.solver->solve_tangent(state.PWe));
    });
}

Eigen::MatrixXd Slopes::curvature_times(const Eigen::MatrixXd& V) const {
    // J^T J V = G^T T^-1 P^T W P T^-1 G V
    return sum_of_parts(static_cast<int>(states_.size()), threads_, [&](int s) -> Eigen::MatrixXd {
        const State& state = states_[s];
        const Eigen::MatrixXd moved = state.PWP * state.solver->solve_tangent(state.G * V);
        return state.G.transpose() * state.solver->solve_tangent(moved);
    });
}

Slopes PositionDomain::slopes(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const Eigen::SparseMatrix<double> dk = parameters_.derivative(k);
    const int count = static_cast<int>(states_.size());

    // the linear law has one tangent for all states
    const bool linear = law() == skeleton::Law::linear;
    Slopes::Loans loans(linear ? 1 : count);
    for (auto& loan : loans) loan = std::make_unique<SolverPool::Loan>(*solvers_);
    if (linear) (*loans[0])->factor_tangent(k, states_[0].load, prediction.equilibria[0]);

    std::vector<Slopes::State> states(count);
    for_each_in_parallel(count, threads_, [&](int s) {
        Slopes::State& state = states[s];
        SolverPool::Loan& loan = *loans[linear ? 0 : s];
        if (!linear) loan->factor_tangent(k, states_[s].load, prediction.equilibria[s]);
        state.solver = &*loan;
        state.G = skeleton::link_forces(*model_, prediction.equilibria[s]) * dk;
        const Eigen::SparseMatrix<double> P =
            linear ? P_[s] : observation_jacobian(*model_, prediction.equilibria[s], states_[s].points);
        state.PWP = P.transpose() * weights_[s].asDiagonal() * P;
        state.PWe = P.transpose() * weights_[s].cwiseProduct(errors(s, prediction.markers[s]));
    });
    return {std::move(states), std::move(loans), threads_};
}

}  // namespace palpate::identify
