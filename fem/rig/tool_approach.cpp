#include "fem/rig/tool_approach.h"

#include <cmath>

namespace palpate::fem {

namespace {

constexpr double fine = 0.05;  // of the radius: how exactly it is found where a tool comes free
constexpr double ahead = 0.5;  // cosine: what comes free by going on has done more than half of that along its motion

class ApproachingTool : public ToolPotential {
public:
    ApproachingTool(std::shared_ptr<const RigidTool> tool, const mesh::ToolMotion& motion, double young,
                    const Vec3& retreat)
        : ToolPotential(tool, motion, young), rigid_(std::move(tool)), retreat_(retreat) {}

    std::shared_ptr<const ToolPotential> part_way(double share) const override {
        return retreated((1 - share) * retreat_);
    }
    double way() const override { return retreat_.norm(); }

    std::shared_ptr<const ToolPotential> retreated(const Vec3& by) const {
        mesh::ToolMotion motion = this->motion();
        motion.translation += by;
        return std::make_shared<ToolPotential>(rigid_, motion, young());
    }

private:
    std::shared_ptr<const RigidTool> rigid_;
    Vec3 retreat_;  // from the pose to where it is off the body [mm]
};

/// Depth by depth, the way that points have to go to come out of the tool [mm].
Vec3 way_out(const ToolPotential& tool, const Points& surface) {
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index i = 0; i < surface.rows(); ++i) {
        const Vec3 point = surface.row(i);
        sum -= tool.terms(point, point).gradient;
    }
    return sum;
}

}  // namespace

std::optional<ToolApproach> from_off_the_body(const ToolPotential& tool, const Points& surface, const Points& held) {
    const Vec3 out = way_out(tool, surface);
    if (!tool.parts() || out.isZero(0)) return {};
    const auto rigid = std::make_shared<RigidTool>(tool.tool());
    const ApproachingTool there(rigid, tool.motion(), tool.young(), Vec3::Zero());
    const Vec3 direction = -out.normalized(), motion = tool.motion().translation.stableNormalized();
    const double stands_off =
        held.rows() > 0 ? (held.rowwise() - tool.origin().transpose()).rowwise().norm().minCoeff() : INFINITY;
    const double step = fine * rigid->shape->radius();
    for (double far = step; far < tool.way(); far += step) {
        if (!way_out(*there.retreated(far * direction), surface).isZero(0)) continue;
        // What is as shallow as one step of a tool needs no way through the body to be there; what has to go back, or
        // aside, to come free has not come through it; and nothing pushes a body further than it stands off its
        // support.
        const bool shallow = far <= tool.reach(),
                   came_through = direction.dot(motion) > ahead && tool.way() < stands_off;
        return ToolApproach{
            .tool = std::make_shared<ApproachingTool>(rigid, tool.motion(), tool.young(), far * direction),
            .likely = far < tool.way() / 2 && (shallow || !came_through)};
    }
    return {};
}

}  // namespace palpate::fem
