#include "identify/diagnosis/likelihood/tool_prints.h"

#include <cmath>

namespace palpate::identify {
namespace {

/// The part of the skin that a tool touches.
struct Print {
    double area = 0;             // [mm^2]
    Vec3 moment = Vec3::Zero();  // area times place at rest [mm^3]
};

Print print_of(const BodyModel& model, const Points& skin, const fem::ToolPotential& tool) {
    Print print;
    for (Eigen::Index s = 0; s < skin.rows(); ++s) {
        const Vec3 rest = model.skin().row(s);
        if (tool.gap(rest, skin.row(s)).value > 0) continue;
        print.area += model.skin_areas()[s];
        print.moment += model.skin_areas()[s] * rest;
    }
    return print;
}

}  // namespace

std::vector<mesh::Contact> tool_prints(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                       const ForwardSolution& forward, int k) {
    std::vector<mesh::Contact> prints;
    const Action& action = forward.actions[k];
    if (action.motions.empty()) return prints;
    const Points skin = model.skin_positions(forward.q[k], setting);
    for (const mesh::ToolMotion& motion : model.motions(forward.q[k], setting, action)) {
        const auto tool = std::make_shared<const fem::RigidTool>(problem.rig->tools[motion.tool]);
        if (!tool->shape) continue;
        const Print print = print_of(model, skin, {tool, motion, model.young(setting)});
        if (print.area == 0) continue;
        prints.push_back({.point = print.moment / print.area,
                          .force = forward.stand[k].row(problem.markers + 2 * Eigen::Index{motion.tool}),
                          .radius = std::sqrt(print.area / M_PI)});
    }
    return prints;
}

}  // namespace palpate::identify
