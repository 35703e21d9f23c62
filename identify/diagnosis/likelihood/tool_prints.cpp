#include "identify/diagnosis/likelihood/tool_prints.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

/// How far points of the skin are from a tool (s) [mm]; infinitely those that stand for no area but by rounding, as
/// corners of quadratic faces do.
Eigen::VectorXd gaps_of(const BodyModel& model, const Points& skin, const fem::ToolPotential& tool) {
    Eigen::VectorXd gaps = Eigen::VectorXd::Constant(skin.rows(), INFINITY);
    const double none = 1e-6 * model.skin_areas().maxCoeff();
    for (Eigen::Index s = 0; s < skin.rows(); ++s)
        if (model.skin_areas()[s] > none) gaps[s] = tool.gap(model.skin().row(s), skin.row(s)).value;
    return gaps;
}

}  // namespace

std::vector<ToolPrint> tool_prints(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                   const ForwardSolution& forward, int k) {
    std::vector<ToolPrint> prints;
    const Action& action = forward.actions[k];
    if (action.motions.empty()) return prints;
    const Points skin = model.skin_positions(forward.q[k], setting);
    const std::vector<mesh::ToolMotion> motions = model.motions(forward.q[k], setting, action);
    for (std::size_t i = 0; i < motions.size(); ++i) {
        const mesh::ToolMotion& motion = motions[i];
        const auto tool = std::make_shared<const fem::RigidTool>(problem.rig->tools[motion.tool]);
        if (!tool->shape) continue;
        const Vec3 felt = forward.channels[k].row(problem.markers + 2 * Eigen::Index{motion.tool});
        if (felt.isZero(0)) continue;
        // Tools touch faces between these points, which stand off by little then; the nearest always counts.
        constexpr double barely_off = 0.01;  // of the tool's radius
        const Eigen::VectorXd gaps = gaps_of(model, skin, {tool, motion, model.young(setting)});
        const double most = std::max(barely_off * tool->shape->radius(), gaps.minCoeff());
        double area = 0, stroke = 0;
        Vec3 moment = Vec3::Zero();
        for (Eigen::Index s = 0; s < gaps.size(); ++s) {
            if (gaps[s] > most) continue;
            area += model.skin_areas()[s];
            moment += model.skin_areas()[s] * model.skin().row(s).transpose();
            stroke = std::max(stroke, (skin.row(s) - model.skin().row(s)).dot(felt.normalized()));
        }
        const mesh::Contact contact{.point = moment / area, .force = felt, .radius = std::sqrt(area / M_PI)};
        prints.push_back({i, contact, stroke});
    }
    return prints;
}

}  // namespace palpate::identify
