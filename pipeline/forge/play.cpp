#include "pipeline/forge/play.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "identify/parallel.h"
#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

using identify::Action;
using identify::Memory;

/// What a body has been through, and how it stands.
struct Life {
    std::shared_ptr<const Memory> memory;
    Eigen::VectorXd last;    // its last configuration; empty: it is new
    Eigen::VectorXd beside;  // that of the similar world, in the same row
};

/// Finds equilibria in one world.
class Statics {
public:
    Statics(const Specimen& specimen, const World& world, bool is_patient)
        : model_(*specimen.model), world_(world), is_patient_(is_patient) {
        rest_ = model_.rest(world.setting);
        // One-sided contact is in force as it stands, whatever the law.
        const bool one_sided =
            std::ranges::any_of(world.setting.effects.points, [](const auto& point) { return point->is_one_sided(); });
        if (!model_.is_nonlinear(world.setting) && !one_sided) linear_ = model_.tangent(rest_, world.setting, {});
    }

    Action action(const Course& course, std::size_t row) const {
        const double gain = course.probe > 0 && course.probe % 2 == 0 ? world_.gain : 1;
        const double force = gain * course.effective_force(row, world_.setting.effects.creep);
        Action action;
        if (force != 0) {
            action.contacts = {course.contact};
            action.contacts.front().force *= force;
        }
        return action;
    }

    Eigen::VectorXd equilibrium(const Action& action, const Eigen::VectorXd* near) const {
        const identify::Setting& setting = world_.setting;
        if (linear_) return model_.advance(rest_, linear_->solve(model_.residual(rest_, setting, action)), setting);
        if (near) {
            try {
                return model_.equilibrium(setting, action, near);
            } catch (const SolverFailure&) {  // too far off: from rest, load by load
                if (!is_patient_) throw;
            }
        }
        return model_.equilibrium(setting, action, nullptr);
    }

    /// `life`: what the body went through before, and then what it has been through.
    Path path(const Course& course, Life& life, const Path* near) const {
        Path path;
        Life now = life;
        try {
            for (std::size_t row = 0; row < course.rows.size(); ++row) {
                Action action = this->action(course, row);
                action.memory = now.memory;
                const Eigen::VectorXd* beside = near && !near->empty() ? &(*near)[row] : nullptr;
                const Eigen::VectorXd start = guess(now, beside);
                path.push_back(equilibrium(action, start.size() > 0 ? &start : nullptr));
                now.memory = model_.remember(path.back(), world_.setting, action);
                now.last = path.back();
                if (beside) now.beside = *beside;
            }
        } catch (const SolverFailure&) {
            return {};
        }
        life = now;
        return path;
    }

private:
    /// Where the search for an equilibrium begins: where the body stands in a similar world. One that yields has
    /// strayed from there: it moves on from where it stands by as much as the other one does.
    Eigen::VectorXd guess(const Life& now, const Eigen::VectorXd* beside) const {
        if (!beside) return now.last;
        const bool strays = now.memory && now.beside.size() == model_.dofs();  // so steps are differences
        return strays ? Eigen::VectorXd(now.last + *beside - now.beside) : *beside;
    }

    const identify::BodyModel& model_;
    const World& world_;
    const bool is_patient_;
    Eigen::VectorXd rest_;
    std::shared_ptr<const identify::Tangent> linear_;  // one factorisation serves all loads; empty: not linear
};

}  // namespace

World world_of(const Specimen& specimen, const std::vector<skeleton::Effect>& effects) {
    World world{.setting = specimen.setting};
    for (const skeleton::Effect& effect : effects) {
        if (const auto known = identify::effect_named(effect.name)) {
            known->hide(effect, world);
        } else {  // a user's, of which no diagnosis knows
            world.setting.effects.add(skeleton::make_physics(effect));
        }
    }
    return world;
}

bool moves_body(const skeleton::Effect& effect) {
    const auto known = identify::effect_named(effect.name);
    return !known || !known->is_of_readings();
}

std::vector<Path> play(const Specimen& specimen, const World& world, const std::vector<Course>& courses,
                       const PlayOptions& options, const std::vector<Path>* near) {
    const Statics statics(specimen, world, options.is_patient);
    std::vector<Path> paths(courses.size());
    Life life;
    std::atomic<int> failures = 0;
    const bool in_order = options.continuous && world.setting.effects.plasticity;
    identify::for_each_in_parallel(static_cast<int>(courses.size()), in_order ? 1 : options.threads, [&](int c) {
        if (failures > options.most_failures) return;
        Life fresh;
        paths[c] = statics.path(courses[c], in_order ? life : fresh, near ? &(*near)[c] : nullptr);
        if (paths[c].empty()) ++failures;
    });
    return paths;
}

std::vector<Points> seen(const Specimen& specimen, const World& world, const std::vector<Course>& courses,
                         const std::vector<Path>& paths) {
    const auto markers = static_cast<Eigen::Index>(specimen.set.markers.size());
    std::vector<Points> result;
    for (std::size_t c = 0; c < courses.size(); ++c) {
        for (std::size_t row = 0; row < courses[c].rows.size(); ++row) {
            if (paths[c].empty()) {
                result.emplace_back(Points::Constant(markers, 3, identify::missing));
            } else {
                result.push_back(
                    world.see(specimen.set.markers, specimen.model->observe(paths[c][row], world.setting)));
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
