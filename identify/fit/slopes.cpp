#include "identify/fit/slopes.h"

#include <algorithm>
#include <optional>

#include "identify/fit/lived.h"
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

/// An equilibrium of a prediction, whether somebody read it or not.
struct Stage {
    int state;  // the one that was read, here or next
    const skeleton::Load* load;
    const skeleton::Equilibrium* at;
    bool is_read;
    int before = -1;  // stage that went before; -1: the body was new
};

/// Of all states, unread ones before the one that was read next.
std::vector<Stage> stages_of(const std::vector<StateReadings>& states, const Prediction& prediction) {
    std::vector<Stage> stages;
    std::vector<int> stage_of(states.size());
    for (int s = 0; s < static_cast<int>(states.size()); ++s) {
        int before = states[s].before >= 0 ? stage_of[states[s].before] : -1;
        const auto append = [&](const skeleton::Load& load, const skeleton::Equilibrium& at, bool is_read) {
            stages.push_back({s, &load, &at, is_read, before});
            before = static_cast<int>(stages.size()) - 1;
        };
        for (std::size_t u = 0; u < prediction.unread[s].size(); ++u) {
            append(states[s].unread[u], prediction.unread[s][u], false);
        }
        append(states[s].load, prediction.equilibria[s], true);
        stage_of[s] = before;
    }
    return stages;
}

}  // namespace

Slopes::Slopes(std::vector<State> states, const Eigen::SparseMatrix<double>& dk, std::vector<TangentSolve> tangents,
               int threads)
    : states_(std::move(states)), dk_(dk), tangents_(std::move(tangents)), threads_(threads) {
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        if (states_[s].P) read_.push_back(s);
    }
}

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

std::vector<Eigen::MatrixXd> Slopes::lived(int last, const Eigen::MatrixXd& K) const {
    std::vector<Eigen::MatrixXd> X(last + 1), Z(last + 1);  // Z: of what has flowed (24L x n)
    for (int s = 0; s <= last; ++s) {
        const Life& life = *states_[s].life;
        Eigen::MatrixXd F = states_[s].G.times(K);
        if (life.before >= 0) F += life.flow.pulls * Z[life.before];
        X[s] = tangents_[s](F);
        Z[s] = life.flow.follows * X[s];
        if (life.before >= 0) Z[s] += life.flow.lasts * Z[life.before];
    }
    return X;
}

Eigen::MatrixXd Slopes::pulled_through(std::vector<Eigen::MatrixXd> F) const {
    std::vector<Eigen::MatrixXd> Z(F.size());  // what the states after it make of what has flowed (24L x n)
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(dk_.rows(), F.front().cols());
    for (int s = static_cast<int>(F.size()) - 1; s >= 0; --s) {
        const Life& life = *states_[s].life;
        if (Z[s].size() > 0) F[s] += life.flow.follows.transpose() * Z[s];
        const Eigen::MatrixXd X = tangents_[s](F[s]);
        sum += states_[s].G.transposed_times(X);
        if (life.before < 0) continue;
        Eigen::MatrixXd handed = life.flow.pulls.transpose() * X;
        if (Z[s].size() > 0) handed += life.flow.lasts.transpose() * Z[s];
        if (Z[life.before].size() == 0) Z[life.before].setZero(handed.rows(), handed.cols());
        Z[life.before] += handed;
    }
    return sum;
}

Eigen::MatrixXd Slopes::seen(const State& state, const Eigen::MatrixXd& X) {
    if (!state.P) return Eigen::MatrixXd::Zero(X.rows(), X.cols());
    const Eigen::MatrixXd weighted = state.weights.asDiagonal() * (*state.P * X).eval();
    return state.P->transpose() * weighted;
}

Eigen::VectorXd Slopes::gradient() const {
    std::vector<Eigen::MatrixXd> d;
    d.reserve(read_.size());
    for (int s = 0; s < count_read(); ++s) d.emplace_back(weights(s).cwiseSqrt().cwiseProduct(errors(s)));
    return transposed_times(d);
}

Eigen::MatrixXd Slopes::transposed_times(const std::vector<Eigen::MatrixXd>& D) const {
    // J = -W^(1/2) P T^-1 G dk/dtheta
    const Eigen::Index n = D.front().cols();
    std::vector<Eigen::MatrixXd> F(states_.size());
    for (std::size_t s = 0; s < F.size(); ++s) F[s].setZero(states_[s].G.dofs(), n);
    for (int s = 0; s < count_read(); ++s) {
        F[read_[s]] = states_[read_[s]].P->transpose() * (weights(s).cwiseSqrt().asDiagonal() * D[s]).eval();
    }
    if (remembers()) return -(dk_.transpose() * pulled_through(std::move(F)));
    const std::vector<States> parts = together(n);
    const Eigen::MatrixXd sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        Eigen::MatrixXd own(F.front().rows(), n * std::ssize(parts[p]));
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            own.middleCols(static_cast<Eigen::Index>(i) * n, n) = F[parts[p][i]];
        }
        return pulled(parts[p], own);
    });
    return -(dk_.transpose() * sum);
}

Eigen::MatrixXd Slopes::curvature_times(const Eigen::MatrixXd& V) const {
    // J^T J V = G^T T^-1 P^T W P T^-1 G V
    const Eigen::MatrixXd K = dk_ * V;
    if (remembers()) {
        std::vector<Eigen::MatrixXd> X = lived(static_cast<int>(states_.size()) - 1, K);
        std::ranges::transform(states_, X, X.begin(), &Slopes::seen);
        return dk_.transpose() * pulled_through(std::move(X));
    }
    const std::vector<States> parts = together(V.cols());
    const Eigen::MatrixXd sum = sum_of_parts(static_cast<int>(parts.size()), threads_, [&](int p) {
        Eigen::MatrixXd X = moved(parts[p], K);
        for (std::size_t i = 0; i < parts[p].size(); ++i) {
            auto own = X.middleCols(static_cast<Eigen::Index>(i) * V.cols(), V.cols());
            own = seen(states_[parts[p][i]], own);
        }
        return pulled(parts[p], X);
    });
    return dk_.transpose() * sum;
}

Eigen::MatrixXd Slopes::steps(const Eigen::VectorXd& step) const {
    const Eigen::VectorXd dk = dk_ * step;
    std::vector<Eigen::MatrixXd> found;
    if (remembers()) {
        found = lived(static_cast<int>(states_.size()) - 1, dk);
    } else {
        const std::vector<States> parts = together(1);
        found.resize(parts.size());
        for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int p) { found[p] = moved(parts[p], dk); });
    }
    Eigen::MatrixXd all(found.front().rows(), std::ssize(states_));
    Eigen::Index column = 0;
    for (const Eigen::MatrixXd& part : found) {
        all.middleCols(column, part.cols()) = part;
        column += part.cols();
    }
    return all;
}

Eigen::MatrixXd Slopes::moved_markers(int state, const Eigen::MatrixXd& V) const {
    const int s = read_[state];
    return *states_[s].P * (remembers() ? lived(s, dk_ * V).back() : moved({s}, dk_ * V));
}

Slopes PositionDomain::slopes(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const bool linear = law() == skeleton::Law::linear;

    const std::vector<Stage> stages = stages_of(states_, prediction);

    // the linear law has one tangent for all states
    const int count = static_cast<int>(stages.size());
    std::vector<TangentSolve> tangents(linear ? 1 : count);
    if (linear) tangents[0] = prediction.tangents.empty() ? linear_tangent(k) : prediction.tangents.front();
    const skeleton::PlacedLinks* const yielding = !linear && remembers(states_) ? &links_->placed : nullptr;
    std::vector<std::optional<Slopes::State>> found(count);
    for_each_in_parallel(count, threads_, [&](int i) {
        const Stage& stage = stages[i];
        const int s = stage.state;
        const bool is_factored = stage.is_read && !prediction.tangents.empty();
        if (!linear) tangents[i] = is_factored ? prediction.tangents[s] : factored(*stage.load, k, *stage.at);
        Slopes::State& state = found[i].emplace(Slopes::State{LinkSignatures(links_, *stage.at, law()), {}, {}, {}});
        if (stage.is_read) {
            state.P = linear ? P_[s]
                             : std::make_shared<Eigen::SparseMatrix<double>>(
                                   observation_jacobian(*model_, *stage.at, states_[s].points));
            state.weights = weights_[s];
            state.errors = errors(s, prediction.markers[s]);
        }
        if (yielding) state.life = {stage.before, yielding->flow_slopes(k, stage.at->state, stage.at->before)};
    });
    std::vector<Slopes::State> all;
    all.reserve(found.size());
    for (auto& state : found) all.push_back(std::move(*state));
    return {std::move(all), parameters_.derivative(k), std::move(tangents), threads_};
}

}  // namespace palpate::identify
