#pragma once

#include "identify/models/tool_path.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {

/// The small bar on a finer mesh, and a ball that presses its upper side down, by up to nearly twice the bar's
/// thickness. The ball's poses count from a place below the bar: one alone might as well lift it from there.
struct BarUnderBall {
    static constexpr double radius = 8, top = 10;  // of the ball, of the bar [mm]

    SmallBody body;
    BarUnderBall() { body.mesh = mesh_of({8, 2, 2}); }

    static mesh::VolumeMesh mesh_of(const Eigen::Vector3i& cells) {
        return mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), cells));
    }
    static Rig rig() {
        return {{{.name = "ball", .shape = mesh::SphereShape{radius}, .bonded = false, .origin = Vec3(30, 5, -60)}},
                {}};
    }
    static Action pressed(double depth) {
        Action action;
        action.motions = {{.tool = 0, .translation = Vec3(0, 0, 60 + top + radius - depth)}};
        return action;
    }
    /// Where the ball has brought the bar, step by step.
    static Eigen::VectorXd brought_to(const BodyModel& model, const ModelSetting& setting, double depth) {
        constexpr double step = 5;
        double now = std::min(step, depth);
        Eigen::VectorXd q = model.equilibrium(setting, pressed(now));
        while (now < depth) {
            const double next = std::min(now + step, depth);
            q = equilibrium_after(model, PreparedRig(rig()), setting, pressed(now), q, pressed(next));
            now = next;
        }
        return q;
    }
    std::unique_ptr<ReferenceBody> reference() const {
        return std::make_unique<ReferenceBody>(
            body.mesh, body.supports, body.markers,
            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig()});
    }
};

}  // namespace palpate::identify
