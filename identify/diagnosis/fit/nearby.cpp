#include "identify/diagnosis/fit/nearby.h"

namespace palpate::identify {

std::optional<Refit> start_at(const NeighbouringFit& near, const Problem& problem) {
    const bool in_stages = near.fit->explanation.has_memory() && !near.problem->by_stage;
    const Problem known = in_stages ? near.problem->stage_by_stage() : *near.problem;
    Refit start = *near.fit;
    start.V.reset();
    start.forward.q.clear();
    for (std::size_t k = 0; k < problem.actions.size(); ++k) {
        const int like = problem.action_in(known, static_cast<int>(k));
        if (like < 0) return std::nullopt;
        start.forward.q.push_back(near.fit->forward.q[like]);
    }
    return start;
}

}  // namespace palpate::identify
