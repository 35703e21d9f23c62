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

/// Where a body's surface is at rest, and which way it looks.
struct RestSurface {
    const Points &points, &normals;

    /// Depth by depth, the way that points within the tool have to go to come out of it [mm].
    Vec3 way_out(const ToolPotential& tool) const {
        Vec3 sum = Vec3::Zero();
        for (Eigen::Index i = 0; i < points.rows(); ++i) sum -= terms(tool, i).gradient;
        return sum;
    }
    /// Which way the surface looks where it is within the tool, depth by depth.
    Vec3 outward(const ToolPotential& tool) const {
        Vec3 sum = Vec3::Zero();
        for (Eigen::Index i = 0; i < points.rows(); ++i)
            sum += terms(tool, i).gradient.norm() * normals.row(i).transpose();
        return sum;
    }
    bool touches(const ToolPotential& tool) const {
        for (Eigen::Index i = 0; i < points.rows(); ++i)
            if (terms(tool, i).energy > 0) return true;
        return false;
    }
    /// By the nearest of the points.
    bool encloses(const Vec3& place) const {
        // Cosine: a place on a rounded surface is beside the nearest point, and hardly below it.
        constexpr double beneath = 0.25;
        Eigen::Index nearest = 0;
        (points.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
        const Vec3 way = place - points.row(nearest).transpose(), normal = normals.row(nearest);
        return way.dot(normal) < -beneath * way.norm() * normal.norm();
    }

private:
    PointTerms terms(const ToolPotential& tool, Eigen::Index i) const {
        const Vec3 point = points.row(i);
        return tool.terms(point, point);
    }
};

}  // namespace

std::optional<ToolApproach> from_off_the_body(const ToolPotential& tool, const Points& surface, const Points& normals,
                                              const Points& held) {
    const RestSurface rest{surface, normals};
    if (!tool.parts() || !rest.touches(tool)) return {};
    const auto rigid = std::make_shared<RigidTool>(tool.tool());
    const ApproachingTool there(rigid, tool.motion(), tool.young(), Vec3::Zero());
    const bool is_about_origin = rigid->shape->gap(tool.tool().origin).value <= 0;
    const Vec3 motion = tool.motion().translation.stableNormalized();
    const double stands_off =
        held.rows() > 0 ? (held.rowwise() - tool.origin().transpose()).rowwise().norm().minCoeff() : INFINITY;
    const double step = fine * rigid->shape->radius();
    // A ball that is pressed in by more than its radius has its centre within the body: what is nearest of the surface
    // would leave it outwards, and it would come free inside.
    for (const Vec3& out : {Vec3(-rest.way_out(tool)), rest.outward(tool)}) {
        if (out.isZero(0)) continue;
        const Vec3 direction = out.normalized();
        double far = step;
        while (far < tool.way() && rest.touches(*there.retreated(far * direction))) far += step;
        if (far >= tool.way()) continue;
        if (is_about_origin && rest.encloses(tool.origin() + far * direction)) continue;
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
