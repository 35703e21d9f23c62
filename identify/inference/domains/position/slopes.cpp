#include "identify/inference/domains/position/slopes.h"

#include <algorithm>

#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

constexpr int batch = 8;            // parts that are held at once, whatever the threads
constexpr Eigen::Index narrow = 6;  // right-hand sides that are solved for at once, or else all,
constexpr Eigen::Index wide = 128;  // and at most

/// The sum of parts (rows x n), in their order.
fem::MultiVector sum_of_parts(int count, int threads, const std::function<fem::MultiVector(int)>& part_of) {
    fem::MultiVector sum;
    for (int first = 0; first < count; first += batch) {
        std::vector<fem::MultiVector> parts(std::min(batch, count - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads, [&](int i) { parts[i] = part_of(first + i); });
        for (const fem::MultiVector& part : parts) {
            if (sum.size() == 0) sum.setZero(part.rows(), part.cols());
            sum += part;
        }
    }
    return sum;
}

}  // namespace

ErrorJacobian::ErrorJacobian(std::vector<State> states, const Eigen::SparseMatrix<double>& dk,
                             std::vector<TangentSolve> tangents, int threads)
    : states_(std::move(states)), dk_(dk), tangents_(std::move(tangents)), threads_(threads) {
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        if (states_[s].P) read_.push_back(s);
    }
}

std::vector<ErrorJacobian::States> ErrorJacobian::together(Eigen::Index n) const {
    const Eigen::Index count = std::ssize(states_);
    Eigen::Index most = 1;
    if (tangents_.size() == 1) {
        const Eigen::Index evenly = (count + batch - 1) / batch;  // so that each thread has some
        most = std::clamp<Eigen::Index>(std::max(evenly, narrow / n), 1, std::max<Eigen::Index>(1, wide / n));
    }
    std::vector<States> parts;
    for (int s = 0; s < count; ++s) {
        if (parts.empty() || std::ssize(parts.back()) == most) parts.emplace_back();
        parts.back().push_back(s);
    }
    return parts;
}

const TangentSolve& ErrorJacobian::tangent(const States& states) const {
    return tangents_.size() == 1 ? tangents_.front() : tangents_[states.front()];
}

fem::MultiVector ErrorJacobian::moved(const States& states, const fem::MultiVector& K) const {
    fem::MultiVector F;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const fem::MultiVector own = states_[states[i]].G.times(K);
        if (i == 0) F.resize(own.rows(), own.cols() * std::ssize(states));
        F.middleCols(static_cast<Eigen::Index>(i) * own.cols(), own.cols()) = own;
    }
    return tangent(states)(F);
}

fem::MultiVector ErrorJacobian::pulled(const States& states, const fem::MultiVector& F) const {
    const fem::MultiVector X = tangent(states)(F);
    const Eigen::Index n = X.cols() / std::ssize(states);
    fem::MultiVector sum = fem::MultiVector::Zero(dk_.rows(), n);
    for (std::size_t i = 0; i < states.size(); ++i) {
        sum += states_[states[i]].G.transposed_times(X.middleCols(static_cast<Eigen::Index>(i) * n, n));
    }
    return sum;
}

std::vector<fem::MultiVector> ErrorJacobian::moved_through(int last, const fem::MultiVector& K) const {
    std::vector<fem::MultiVector> X(last + 1), Z(last + 1);  // Z: of what has flowed (36L x n)
    for (int s = 0; s <= last; ++s) {
        const FlowHistory& history = *states_[s].history;
        fem::MultiVector F = states_[s].G.times(K);
        if (history.before >= 0) F += history.flow.force_by_flow * Z[history.before];
        X[s] = tangents_[s](F);
        Z[s] = history.flow.flow_by_step * X[s];
        if (history.before >= 0) Z[s] += history.flow.flow_by_flow * Z[history.before];
    }
    return X;
}

fem::MultiVector ErrorJacobian::pulled_through(std::vector<fem::MultiVector> F) const {
    std::vector<fem::MultiVector> Z(F.size());  // what the states after it make of what has flowed (36L x n)
    fem::MultiVector sum = fem::MultiVector::Zero(dk_.rows(), F.front().cols());
    for (int s = static_cast<int>(F.size()) - 1; s >= 0; --s) {
        const FlowHistory& history = *states_[s].history;
        if (Z[s].size() > 0) F[s] += history.flow.flow_by_step.transpose() * Z[s];
        const fem::MultiVector X = tangents_[s](F[s]);
        sum += states_[s].G.transposed_times(X);
        if (history.before < 0) continue;
        fem::MultiVector handed = history.flow.force_by_flow.transpose() * X;
        if (Z[s].size() > 0) handed += history.flow.flow_by_flow.transpose() * Z[s];
        if (Z[history.before].size() == 0) Z[history.before].setZero(handed.rows(), handed.cols());
        Z[history.before] += handed;
    }
    return sum;
}

fem::MultiVector ErrorJacobian::seen(const State& state, const fem::MultiVector& X) {
    if (!state.P) return fem::MultiVector::Zero(X.rows(), X.cols());
    const fem::MultiVector weighted = state.weights.asDiagonal() * (*state.P * X).eval();
    return state.P->transpose() * weighted;
}

Eigen::VectorXd ErrorJacobian::gradient() const {
    std::vector<Eigen::MatrixXd> d;
    d.reserve(read_.size());
    for (int s = 0; s < count_read(); ++s) d.emplace_back(weights(s).cwiseSqrt().cwiseProduct(errors(s)));
    return transposed_times(d);
}

Eigen::MatrixXd ErrorJacobian::transposed_times(const std::vector<Eigen::MatrixXd>& D) const {
    // J = -W^(1/2) P T^-1 G dk/dtheta
    const Eigen::Index n = D.front().cols();
    std::vector<fem::MultiVector> F(states_.size());
    for (std::size_t s = 0; s < F.size(); ++s) F[s].setZero(states_[s].G.dofs(), n);
    for (int s = 0; s < count_read(); ++s) {
        F[read_[s]] = states_[read_[s]].P->transpose() * (weights(s).cwiseSqrt().asDiagonal() * D[s]).eval();
    }
    if (is_history_dependent()) return -(dk_.transpose() * pulled_through(std::move(F)));
    const std::vector<States> parts = together(n);
    const fem::MultiVector sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        fem::MultiVector own(F.front().rows(), n * std::ssize(parts[p]));
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            own.middleCols(static_cast<Eigen::Index>(i) * n, n) = F[parts[p][i]];
        }
        return pulled(parts[p], own);
    });
    return -(dk_.transpose() * sum);
}

Eigen::MatrixXd ErrorJacobian::curvature_times(const Eigen::MatrixXd& V) const {
    // J^T J V = G^T T^-1 P^T W P T^-1 G V
    const fem::MultiVector K = dk_ * fem::MultiVector(V);
    if (is_history_dependent()) {
        std::vector<fem::MultiVector> X = moved_through(static_cast<int>(states_.size()) - 1, K);
        std::ranges::transform(states_, X, X.begin(), &ErrorJacobian::seen);
        return dk_.transpose() * pulled_through(std::move(X));
    }
    const std::vector<States> parts = together(V.cols());
    const fem::MultiVector sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        fem::MultiVector X = moved(parts[p], K);
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            auto own = X.middleCols(static_cast<Eigen::Index>(i) * V.cols(), V.cols());
            own = seen(states_[parts[p][i]], own);
        }
        return pulled(parts[p], X);
    });
    return dk_.transpose() * sum;
}

Eigen::MatrixXd ErrorJacobian::steps(const Eigen::VectorXd& step) const {
    const Eigen::VectorXd dk = dk_ * step;
    std::vector<fem::MultiVector> found;
    if (is_history_dependent()) {
        found = moved_through(static_cast<int>(states_.size()) - 1, dk);
    } else {
        const std::vector<States> parts = together(1);
        found.resize(parts.size());
        for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int p) { found[p] = moved(parts[p], dk); });
    }
    Eigen::MatrixXd all(found.front().rows(), std::ssize(states_));
    Eigen::Index column = 0;
    for (const fem::MultiVector& part : found) {
        all.middleCols(column, part.cols()) = part;
        column += part.cols();
    }
    return all;
}

Eigen::MatrixXd ErrorJacobian::moved_markers(int state, const Eigen::MatrixXd& V) const {
    const int s = read_[state];
    const fem::MultiVector K = dk_ * fem::MultiVector(V);
    return *states_[s].P * (is_history_dependent() ? moved_through(s, K).back() : moved({s}, K));
}

}  // namespace palpate::identify
