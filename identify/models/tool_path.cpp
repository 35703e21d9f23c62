#include "identify/models/tool_path.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double any_young = 1;  // [MPa]: no way, and no reach, depends on it

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
        const auto tool = rig.tool(step, any_young);
        most = std::max(most, tool->way() / tool->reach());
    }
    constexpr double limit = 1000;  // against a slip in the unit, as on the way from rest
    return static_cast<int>(std::ceil(std::min(most, limit)));
}

}  // namespace

bool is_reached_from(const Action& before, const Action& action) {
    return !action.motions.empty() && std::ranges::all_of(action.motions, [&](const mesh::ToolMotion& motion) {
        return motion_of(before, motion.tool) != nullptr;
    });
}

Action on_the_way(const Action& before, const Action& action, double share) {
    const std::vector<mesh::ToolMotion> steps = steps_to(before, action);
    Action there = action;
    for (std::size_t t = 0; t < steps.size(); ++t) {
        there.motions[t].translation -= (1 - share) * steps[t].translation;
        there.motions[t].rotation -= (1 - share) * steps[t].rotation;
    }
    return there;
}

namespace {

/// Does some tool that only pushes push the other way than before? Over a small step that tells of a body that has
/// leapt to another of its equilibria.
bool has_turned(const PreparedRig& rig, const std::vector<mesh::ToolMotion>& motions, const Eigen::VectorXd& before,
                const Eigen::VectorXd& now) {
    for (std::size_t t = 0; t < motions.size(); ++t) {
        const auto at = static_cast<Eigen::Index>(6 * t);
        if (before.segment<3>(at).dot(now.segment<3>(at)) < 0 && rig.tool(motions[t], any_young)->parts()) return true;
    }
    return false;
}

/// Where the body comes to when the tools have gone their steps in so many parts, from a configuration; nothing where
/// it leaps on the way.
std::optional<Eigen::VectorXd> follow(const BodyStatics& body, const PreparedRig& rig, const ModelSetting& setting,
                                      const Action& before, const Action& action, int parts, Eigen::VectorXd q) {
    Eigen::VectorXd forces = body.reactions(q, setting, on_the_way(before, action, 0));
    for (int part = 1; part <= parts; ++part) {
        const Action there = on_the_way(before, action, static_cast<double>(part) / parts);
        try {
            q = body.equilibrium(setting, there, &q);
        } catch (const SolverFailure&) {
            return std::nullopt;
        }
        const Eigen::VectorXd now = body.reactions(q, setting, there);
        if (has_turned(rig, there.motions, forces, now)) return std::nullopt;
        forces = now;
    }
    return q;
}

}  // namespace

Eigen::VectorXd equilibrium_after(const BodyStatics& body, const PreparedRig& rig, const ModelSetting& setting,
                                  const Action& before, const Eigen::VectorXd& q, const Action& action) {
    const int parts = parts_of(rig, steps_to(before, action));
    for (const int finer : {1, 4}) {
        if (const auto found = follow(body, rig, setting, before, action, finer * parts, q)) return *found;
    }
    return body.equilibrium(setting, action);
}

}  // namespace palpate::identify
