#include "pipeline/synthesis/loading/simulation.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "identify/loading/history/lagged_load.h"
#include "identify/models/tool_path.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

using identify::Action;
using identify::Memory;

/// What a body has been through, and how it stands.
struct BodyHistory {
    std::shared_ptr<const Memory> memory;
    Eigen::VectorXd last;    // its last configuration; empty: it is new
    Eigen::VectorXd beside;  // that of the similar world, in the same row
};

/// Finds equilibria in one world.
class Statics {
public:
    Statics(const Specimen& specimen, const TrueConditions& conditions, bool is_patient)
        : model_(*specimen.model),
          rig_({specimen.set.tools, specimen.set.actuators}),
          conditions_(conditions),
          is_patient_(is_patient) {
        rest_ = model_.rest(conditions.setting);
        // One-sided contact is in force as it stands, whatever the law.
        const bool one_sided = std::ranges::any_of(conditions.setting.effects.points,
                                                   [](const auto& point) { return point->is_one_sided(); });
        if (!model_.is_nonlinear(conditions.setting) && !one_sided && specimen.driven.empty())
            linear_ = model_.tangent(rest_, conditions.setting, {});
    }

    Action action(const ProbeLoadHistory& history, std::size_t row) const {
        const double gain = history.probe > 0 && history.probe % 2 == 0 ? conditions_.gain : 1;
        const double force = gain * history.lagged_force(row, conditions_.lag, conditions_.setting.effects.creep);
        Action action;
        if (history.drive.drives()) {
            action.motions = history.motions(history.lagged_force(row, conditions_.lag, {}));
            action.settings = history.settings(force);
            std::vector<double> before;
            for (std::size_t earlier = 0; earlier < row; ++earlier)
                before.push_back(gain * history.lagged_force(earlier, conditions_.lag, {}));
            for (mesh::ActuatorSetting& setting : action.settings)
                setting.earlier = identify::since_largest(before, setting.value);
            action = conditions_.act(std::move(action));
        } else if (force != 0) {
            action.contacts = {history.contact};
            action.contacts.front().force *= force;
        }
        return action;
    }

    /// `near`: of a similar state, or empty; `before`: the last row's, from where tools move on, or none, in `last`.
    Eigen::VectorXd equilibrium(const Action& action, const Eigen::VectorXd& near, const Action* before,
                                const Eigen::VectorXd& last) const {
        const identify::ModelSetting& setting = conditions_.setting;
        if (linear_) return model_.advance(rest_, linear_->solve(model_.residual(rest_, setting, action)), setting);
        if (near.size() > 0) {
            try {
                return model_.equilibrium(setting, action, &near);
            } catch (const SolverFailure&) {  // too far off: by the tool's path, or from rest, load by load
                if (!is_patient_) throw;
            }
        }
        if (before) return identify::equilibrium_after(model_, rig_, setting, *before, last, action);
        return model_.equilibrium(setting, action, nullptr);
    }

    /// `body_history`: what the body went through before, and then what it has been through.
    EquilibriumPath path(const ProbeLoadHistory& history, BodyHistory& body_history,
                         const EquilibriumPath* near) const {
        EquilibriumPath path;
        BodyHistory now = body_history;
        Action before;  // of the row before
        try {
            for (std::size_t row = 0; row < history.rows.size(); ++row) {
                Action action = this->action(history, row);
                action.memory = now.memory;
                const Eigen::VectorXd* beside = near && !near->empty() ? &(*near)[row] : nullptr;
                const bool goes_on = row > 0 && identify::is_reached_from(before, action);
                const Eigen::VectorXd near_by = goes_on && !beside ? Eigen::VectorXd() : guess(now, beside);
                path.push_back(equilibrium(action, near_by, goes_on ? &before : nullptr, now.last));
                before = action;
                now.memory = model_.remember(path.back(), conditions_.setting, action);
                now.last = path.back();
                if (beside) now.beside = *beside;
            }
        } catch (const SolverFailure&) {
            return {};
        }
        body_history = now;
        return path;
    }

private:
    /// Where the search for an equilibrium begins: where the body stands in a similar world. One that yields has
    /// strayed from there: it moves on from where it stands by as much as the other one does.
    Eigen::VectorXd guess(const BodyHistory& now, const Eigen::VectorXd* beside) const {
        if (!beside) return now.last;
        const bool strays = now.memory && now.beside.size() == model_.dofs();  // so steps are differences
        return strays ? Eigen::VectorXd(now.last + *beside - now.beside) : *beside;
    }

    const identify::BodyModel& model_;
    const identify::PreparedRig rig_;
    const TrueConditions& conditions_;
    const bool is_patient_;
    Eigen::VectorXd rest_;
    std::shared_ptr<const identify::Tangent> linear_;  // one factorisation serves all loads; empty: not linear
};

}  // namespace

TrueConditions true_conditions(const Specimen& specimen, const std::vector<skeleton::EffectRecord>& effects) {
    TrueConditions conditions{.setting = specimen.setting};
    for (const skeleton::EffectRecord& effect : effects) {
        if (const auto known = identify::effect_named(effect.name)) {
            known->hide(effect, conditions);
        } else {  // a user's, of which no diagnosis knows
            conditions.setting.effects.add(skeleton::make_physics(effect));
        }
    }
    return conditions;
}

bool changes_equilibrium(const skeleton::EffectRecord& effect) {
    const auto known = identify::effect_named(effect.name);
    return !known || !known->is_of_readings();
}

std::vector<EquilibriumPath> simulate(const Specimen& specimen, const TrueConditions& conditions,
                                      const std::vector<ProbeLoadHistory>& histories, const SimulationOptions& options,
                                      const std::vector<EquilibriumPath>* near) {
    const Statics statics(specimen, conditions, options.is_patient);
    std::vector<EquilibriumPath> paths(histories.size());
    BodyHistory body_history;
    std::atomic<int> failures = 0;
    const bool in_order = options.continuous && conditions.setting.effects.remember();
    identify::for_each_in_parallel(static_cast<int>(histories.size()), in_order ? 1 : options.threads, [&](int c) {
        if (failures > options.most_failures) return;
        BodyHistory fresh;
        paths[c] = statics.path(histories[c], in_order ? body_history : fresh, near ? &(*near)[c] : nullptr);
        if (paths[c].empty()) ++failures;
    });
    return paths;
}

std::vector<Points> seen(const Specimen& specimen, const TrueConditions& conditions,
                         const std::vector<ProbeLoadHistory>& histories, const std::vector<EquilibriumPath>& paths) {
    const auto markers = static_cast<Eigen::Index>(specimen.set.markers.size());
    std::vector<Points> result;
    for (std::size_t c = 0; c < histories.size(); ++c) {
        for (std::size_t row = 0; row < histories[c].rows.size(); ++row) {
            if (paths[c].empty()) {
                result.emplace_back(Points::Constant(markers, 3, identify::missing));
            } else {
                result.push_back(
                    conditions.see(specimen.set.markers, specimen.model->observe(paths[c][row], conditions.setting)));
            }
        }
    }
    return result;
}

double largest_distance(const Specimen& specimen, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const auto largest = [](const Points& difference) {
        return difference.rows() > 0 ? difference.rowwise().norm().maxCoeff() : 0;
    };
    const identify::BodyModel& model = *specimen.model;
    return std::max(largest(model.observe(a, specimen.setting) - model.observe(b, specimen.setting)),
                    largest(model.skin_positions(a, specimen.setting) - model.skin_positions(b, specimen.setting)));
}

}  // namespace palpate::pipeline
