#include "identify/models/tool_path.h"

#include <algorithm>
#include <cmath>

#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

const mesh::ToolMotion* motion_of(const Action& action, int tool) {
    const auto found = std::ranges::find(action.motions, tool, &mesh::ToolMotion::tool);
    return found == action.motions.end() ? nullptr : &*found;
}

/// b - a, nothing along coordinates that are free in either.
Vec3 known_difference(const Vec3& b, const Vec3& a) {
    const Vec3 difference = b - a;
    return difference.array().isNaN().select(0, difference);
}

/// What an action's tools have ahead of them.
std::vector<mesh::ToolMotion> steps_to(const Action& before, const Action& action) {
    std::vector<mesh::ToolMotion> steps;
    steps.reserve(action.motions.size());
    for (const mesh::ToolMotion& to : action.motions) {
        const mesh::ToolMotion& from = *motion_of(before, to.tool);
        steps.push_back({to.tool, known_difference(to.translation, from.translation),
                         known_difference(to.rotation, from.rotation)});
    }
    return steps;
}

int parts_of(const PreparedRig& rig, const std::vector<mesh::ToolMotion>& steps) {
    double most = 1;
    for (const mesh::ToolMotion& step : steps) {
        constexpr double any = 1;  // Young's modulus, on which neither depends
        const auto tool = rig.tool(step, any);
        most = std::max(most, tool->way() / tool->reach());
    }
    constexpr double limit = 1000;
    return static_cast<int>(std::ceil(std::min(most, limit)));
}

}  // namespace

bool is_reached_from(const Action& before, const Action& action) {
    return !action.motions.empty() && std::ranges::all_of(action.motions, [&](const mesh::ToolMotion& motion) {
        return motion_of(before, motion.tool) != nullptr;
    });
}

Eigen::VectorXd equilibrium_after(const BodyStatics& body, const PreparedRig& rig, const ModelSetting& setting,
                                  const Action& before, const Eigen::VectorXd& q, const Action& action) {
    const std::vector<mesh::ToolMotion> steps = steps_to(before, action);
    const int parts = parts_of(rig, steps);
    try {
        Eigen::VectorXd at = q;
        Action on_the_way = action;
        for (int part = 1; part <= parts; ++part) {
            const double left = 1 - static_cast<double>(part) / parts;
            for (std::size_t t = 0; t < steps.size(); ++t) {
                const mesh::ToolMotion rest = mesh::scaled(steps[t], left);
                on_the_way.motions[t].translation = action.motions[t].translation - rest.translation;
                on_the_way.motions[t].rotation = action.motions[t].rotation - rest.rotation;
            }
            at = body.equilibrium(setting, on_the_way, &at);
        }
        return at;
    } catch (const SolverFailure&) {
        return body.equilibrium(setting, action);
    }
}

}  // namespace palpate::identify
