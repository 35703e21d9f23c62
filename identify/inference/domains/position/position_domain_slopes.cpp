#include <optional>

#include "identify/inference/domains/position/position_domain.h"
#include "identify/loading/history/load_history.h"
#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

/// An equilibrium of a prediction, whether somebody read it or not.
struct PredictedStage {
    int state;  // the one that was read, here or next
    const skeleton::Load* load;
    const skeleton::Equilibrium* at;
    bool is_read;
    int before = -1;  // stage that went before; -1: the body was new
};

/// Of all states, unmeasured ones before the one that was read next.
std::vector<PredictedStage> stages_of(const std::vector<StateReadings>& states, const Prediction& prediction) {
    std::vector<PredictedStage> stages;
    std::vector<int> stage_of(states.size());
    for (int s = 0; s < static_cast<int>(states.size()); ++s) {
        int before = states[s].before >= 0 ? stage_of[states[s].before] : -1;
        const auto append = [&](const skeleton::Load& load, const skeleton::Equilibrium& at, bool is_read) {
            stages.push_back({s, &load, &at, is_read, before});
            before = static_cast<int>(stages.size()) - 1;
        };
        for (std::size_t u = 0; u < prediction.unmeasured[s].size(); ++u) {
            append(states[s].unmeasured[u], prediction.unmeasured[s][u], false);
        }
        append(states[s].load, prediction.equilibria[s], true);
        stage_of[s] = before;
    }
    return stages;
}

}  // namespace

ErrorJacobian PositionDomain::jacobian(const Eigen::VectorXd& theta, const Prediction& prediction, int threads) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const bool linear = law() == skeleton::EquilibriumLaw::linear;

    const std::vector<PredictedStage> stages = stages_of(states_, prediction);

    // the linear law has one tangent for all states
    const int count = static_cast<int>(stages.size());
    std::vector<TangentSolve> tangents(linear ? 1 : count);
    if (linear) tangents[0] = prediction.tangents.empty() ? linear_tangent(k) : prediction.tangents.front();
    const skeleton::PlacedLinks* const yielding = !linear && is_history_dependent(states_) ? &links_->placed : nullptr;
    std::vector<std::optional<ErrorJacobian::State>> found(count);
    for_each_in_parallel(count, threads, [&](int i) {
        const PredictedStage& stage = stages[i];
        const int s = stage.state;
        const bool is_factored = stage.is_read && !prediction.tangents.empty();
        if (!linear) tangents[i] = is_factored ? prediction.tangents[s] : factored(*stage.load, k, *stage.at);
        ErrorJacobian::State& state =
            found[i].emplace(ErrorJacobian::State{LinkSignatures(links_, *stage.at, law()), {}, {}, {}});
        if (stage.is_read) {
            state.P = linear ? P_[s]
                             : std::make_shared<Eigen::SparseMatrix<double>>(
                                   observation_jacobian(*model_, *stage.at, states_[s].points));
            state.weights = weights_[s];
            state.errors = errors(s, prediction.markers[s]);
        }
        if (yielding) state.history = {stage.before, yielding->flow_derivatives(k, stage.at->state, stage.at->before)};
    });
    std::vector<ErrorJacobian::State> all;
    all.reserve(found.size());
    for (auto& state : found) all.push_back(std::move(*state));
    return {std::move(all), parameters_.derivative(k), std::move(tangents), threads};
}

}  // namespace palpate::identify
