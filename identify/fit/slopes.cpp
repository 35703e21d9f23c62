#include "identify/fit/slopes.h"

#include <algorithm>
#include <optional>

#include "identify/fit/position_domain.h"
#include "identify/parallel.h"

namespace palpate::identify {
namespace {

constexpr int batch = 8;            // parts that are held at once, whatever the threads
constexpr Eigen::Index wide = 128;  // right-hand sides that are solved for at once

/// The sum of parts (rows x n), in their order.
Eigen::MatrixXd sum_of_parts(int count, int threads, const std::function<Eigen::MatrixXd(int)>& part_of) {
    Eigen::MatrixXd sum;
    for (int first = 0; first < count; first += batch) {
        std::vector<Eigen::MatrixXd> parts(std::min(batch, count - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads, [&](int i) { parts[i] = part_of(first + i); });
        for (const Eigen::MatrixXd& part : parts) {
            if (sum.size() == 0) sum.setZero(part.rows(), part.cols());
            sum += part;
        }
    }
    return sum;
}

}  // namespace

std::vector<Slopes::States> Slopes::together(Eigen::Index n) const {
    const bool shared = tangents_.size() == 1;
    const auto most = static_cast<std::size_t>(shared ? std::max<Eigen::Index>(1, wide / n) : 1);
    std::vector<States> parts;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        if (parts.empty() || parts.back().size() == most) parts.emplace_back();
        parts.back().push_back(s);
    }
    return parts;
}

const TangentSolve& Slopes::tangent(const States& states) const {
    return tangents_.size() == 1 ? tangents_.front() : tangents_[states.front()];
}

Eigen::MatrixXd Slopes::moved(const States& states, const Eigen::MatrixXd& K) const {
    Eigen::MatrixXd F;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const Eigen::MatrixXd own = states_[states[i]].G.times(K);
        if (i == 0) F.resize(own.rows(), own.cols() * std::ssize(states));
        F.middleCols(static_cast<Eigen::Index>(i) * own.cols(), own.cols()) = own;
    }
    return tangent(states)(F);
}

Eigen::MatrixXd Slopes::pulled(const States& states, const Eigen::MatrixXd& F) const {
    const Eigen::MatrixXd X = tangent(states)(F);
    const Eigen::Index n = X.cols() / std::ssize(states);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(dk_.rows(), n);
    for (std::size_t i = 0; i < states.size(); ++i) {
        sum += states_[states[i]].G.transposed_times(X.middleCols(static_cast<Eigen::Index>(i) * n, n));
    }
    return sum;
}

Eigen::VectorXd Slopes::gradient() const {
    // J^T d = -G^T T^-1 P^T W (measured - modelled)
    const std::vector<States> parts = together(1);
    const Eigen::MatrixXd sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        Eigen::MatrixXd F;
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            const State& state = states_[parts[p][i]];
            if (i == 0) F.resize(state.P->cols(), std::ssize(parts[p]));
            F.col(static_cast<Eigen::Index>(i)) = state.P->transpose() * state.weights.cwiseProduct(state.errors);
        }
        return pulled(parts[p], F);
    });
    return -(dk_.transpose() * sum.col(0));
}

Eigen::MatrixXd Slopes::curvature_times(const Eigen::MatrixXd& V) const {
    // J^T J V = G^T T^-1 P^T W P T^-1 G V
    const Eigen::MatrixXd K = dk_ * V;
    const std::vector<States> parts = together(V.cols());
    const Eigen::MatrixXd sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        Eigen::MatrixXd X = moved(parts[p], K);
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            const State& state = states_[parts[p][i]];
            auto own = X.middleCols(static_cast<Eigen::Index>(i) * V.cols(), V.cols());
            const Eigen::MatrixXd seen = state.weights.asDiagonal() * (*state.P * own).eval();
            own = state.P->transpose() * seen;
        }
        return pulled(parts[p], X);
    });
    return dk_.transpose() * sum;
}

Eigen::MatrixXd Slopes::steps(const Eigen::VectorXd& step) const {
    const Eigen::VectorXd dk = dk_ * step;
    const std::vector<States> parts = together(1);
    std::vector<Eigen::MatrixXd> found(parts.size());
    for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int p) { found[p] = moved(parts[p], dk); });
    Eigen::MatrixXd all(found.front().rows(), std::ssize(states_));
    Eigen::Index column = 0;
    for (const Eigen::MatrixXd& part : found) {
        all.middleCols(column, part.cols()) = part;
        column += part.cols();
    }
    return all;
}

Eigen::MatrixXd Slopes::moved_markers(int state, const Eigen::MatrixXd& V) const {
    return *states_[state].P * moved({state}, dk_ * V);
}

Slopes PositionDomain::slopes(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const int count = static_cast<int>(states_.size());
    const bool linear = law() == skeleton::Law::linear, has_tangents = !prediction.tangents.empty();

    // the linear law has one tangent for all states
    std::vector<TangentSolve> tangents = prediction.tangents;
    if (linear && !has_tangents) tangents = {linear_tangent(k)};
    if (!linear) tangents.resize(count);
    std::vector<std::optional<Slopes::State>> states(count);
    for_each_in_parallel(count, threads_, [&](int s) {
        const skeleton::Equilibrium& at = prediction.equilibria[s];
        if (!linear && !has_tangents) tangents[s] = factored(s, k, at);
        states[s].emplace(Slopes::State{LinkSignatures(links_, at, law()),
                                        linear ? P_[s]
                                               : std::make_shared<Eigen::SparseMatrix<double>>(
                                                     observation_jacobian(*model_, at, states_[s].points)),
                                        weights_[s], errors(s, prediction.markers[s])});
    });
    std::vector<Slopes::State> found;
    found.reserve(states.size());
    for (auto& state : states) found.push_back(std::move(*state));
    return {std::move(found), parameters_.derivative(k), std::move(tangents), threads_};
}

}  // namespace palpate::identify
