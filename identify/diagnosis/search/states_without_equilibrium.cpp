#include "identify/diagnosis/search/states_without_equilibrium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/diagnosis/search/baselines.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The largest pressure under a contact [MPa].
double pressure_of(const BodyModel& model, const Action& action) {
    double pressure = 0;
    for (const mesh::Contact& contact : action.contacts) {
        const double r = effective_radius(model, contact);
        pressure = std::max(pressure, contact.force.norm() / (M_PI * r * r));
    }
    return pressure;
}

/// The model as it starts, under its last law.
Explanation explanation_at_start(const BodyModel& model) {
    Explanation explanation{.law = static_cast<int>(model.laws().size()) - 1,
                            .theta = Eigen::VectorXd(std::ssize(model.parameters())),
                            .effects = {},
                            .values = {}};
    for (Eigen::Index p = 0; p < explanation.theta.size(); ++p) explanation.theta[p] = model.parameters()[p].start;
    return explanation;
}

/// Does the model find equilibria where of the actions only these act, one after the other?
bool has_equilibria(const BodyModel& model, const Problem& problem, const std::vector<int>& actions,
                    const Explanation& explanation, int threads) {
    std::vector<char> drop(problem.actions.size(), 1);
    for (const int k : actions) drop[k] = 0;
    try {
        solve_forward(model, problem.without_actions(drop), explanation, threads);
        return true;
    } catch (const SolverFailure&) {
        return false;
    }
}

/// Those actions of one probe, in order, that can be reached with the others.
std::vector<int> reached(const BodyModel& model, const Problem& problem, const std::vector<int>& actions,
                         const Explanation& explanation, int threads) {
    if (has_equilibria(model, problem, actions, explanation, threads)) return actions;
    std::vector<int> kept;
    for (const int k : actions) {
        kept.push_back(k);
        if (!has_equilibria(model, problem, kept, explanation, threads)) kept.pop_back();
    }
    return kept;
}

/// How an action's state is called in the set.
std::string state_name(const Problem& problem, int k) {
    const auto row = std::ranges::find(problem.action, k) - problem.action.begin();
    if (row == std::ssize(problem.action)) return fmt::format("probe {}", problem.probe[k]);
    const Stage& stage = problem.stages[problem.state[row]];
    return fmt::format("probe {} at time {:g}", stage.probe, stage.time);
}

}  // namespace

Problem without_crushing_probes(const BodyModel& model, const Problem& problem, int threads,
                                std::vector<std::string>& notes) {
    ModelSetting setting = first_guess(model, problem, 0, threads).setting();
    const double E = model.young(setting);
    setting.law = static_cast<int>(model.laws().size()) - 1;

    std::vector<char> crushing(problem.actions.size(), 0);
    for (std::size_t k = 0; k < crushing.size(); ++k) {
        const double pressure = pressure_of(model, problem.actions[k]);
        if (pressure < E || has_equilibrium(model, setting, problem.actions[k])) continue;
        crushing[k] = 1;
        notes.push_back(
            fmt::format("Probe {} presses with {:.3g} MPa on a body of about {:.3g} MPa and has no equilibrium there: "
                        "it is left out.",
                        problem.probe[k], pressure, E));
    }
    if (std::ranges::count(crushing, 1) == 0) return problem;
    Problem rest = problem.without_actions(crushing);
    for (std::size_t k = 0; k < rest.actions.size(); ++k) {
        if (rest.loaded(static_cast<int>(k))) return rest;
    }
    throw SolverFailure(
        fmt::format("no probe has an equilibrium: every contact pressure exceeds the stiffness of about {:.3g} MPa. "
                    "Check the unit of the forces and the radii of the contacts.",
                    E));
}

Problem without_unreached_tools(const BodyModel& model, const Problem& problem, int threads,
                                std::vector<std::string>& notes) {
    const Explanation explanation = explanation_at_start(model);
    std::map<int, std::vector<int>> with_tools;  // of each probe
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k)
        if (!problem.actions[k].motions.empty()) with_tools[problem.probe[k]].push_back(k);
    std::vector<char> unreached(problem.actions.size(), 0);
    bool has_any = false;
    for (const auto& [_, actions] : with_tools) {
        const std::vector<int> kept = reached(model, problem, actions, explanation, threads);
        has_any |= !kept.empty();
        for (const int k : actions) unreached[k] = !std::ranges::binary_search(kept, k);
    }
    if (!has_any || std::ranges::count(unreached, 1) == 0) return problem;
    for (int k = 0; k < static_cast<int>(unreached.size()); ++k) {
        if (!unreached[k]) continue;
        notes.push_back(
            fmt::format("No equilibrium was found where the tool \"{}\" stands in {}: the state is left out. "
                        "Check the motion there, and whether the tool keeps in touch with the body.",
                        problem.rig->tools[problem.actions[k].motions.front().tool].name, state_name(problem, k)));
    }
    return problem.without_actions(unreached);
}

}  // namespace palpate::identify
