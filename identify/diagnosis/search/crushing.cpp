#include "identify/diagnosis/search/crushing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace palpate::identify
