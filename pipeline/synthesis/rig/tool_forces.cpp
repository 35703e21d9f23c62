#include "pipeline/synthesis/rig/tool_forces.h"

namespace palpate::pipeline {

std::vector<identify::ReactionReading> reactions_of(const Specimen& specimen, const TrueConditions& conditions,
                                                    const ProbeLoadHistory& history, std::size_t row,
                                                    const Eigen::VectorXd& q) {
    identify::Action action;
    action.motions = history.motions(history.lagged_force(row, conditions.lag, {}));
    if (action.motions.empty()) return {};
    const Eigen::VectorXd all = specimen.model->reactions(q, conditions.setting, conditions.act(action));
    std::vector<identify::ReactionReading> readings;
    readings.reserve(action.motions.size());
    for (std::size_t m = 0; m < action.motions.size(); ++m) {
        readings.push_back({.tool = action.motions[m].tool, .force = all.segment<3>(6 * static_cast<Eigen::Index>(m))});
    }
    return readings;
}

std::vector<Points> forces_of_tools(const Specimen& specimen, const TrueConditions& conditions,
                                    const std::vector<ProbeLoadHistory>& histories,
                                    const std::vector<EquilibriumPath>& paths) {
    std::vector<Points> result;
    for (std::size_t c = 0; c < histories.size(); ++c) {
        for (std::size_t row = 0; row < histories[c].rows.size(); ++row) {
            if (paths[c].empty()) {
                result.emplace_back(Points::Constant(1, 3, identify::missing));
                continue;
            }
            const auto readings = reactions_of(specimen, conditions, histories[c], row, paths[c][row]);
            Points& forces = result.emplace_back(std::ssize(readings), 3);
            for (std::size_t r = 0; r < readings.size(); ++r)
                forces.row(static_cast<Eigen::Index>(r)) = readings[r].force.transpose();
        }
    }
    return result;
}

}  // namespace palpate::pipeline
