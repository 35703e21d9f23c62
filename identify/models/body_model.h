#pragma once

#include "identify/models/body_geometry.h"
#include "identify/models/body_observation.h"
#include "identify/models/body_statics.h"

namespace palpate::identify {

/// A model of a body, as identification, comparison and diagnosis see it: they do not know whether it is made of finite
/// elements or of spheres and links.
class BodyModel : public BodyStatics, public BodyObservation {
public:
    ~BodyModel() override = default;

    virtual const BodyGeometry& geometry() const = 0;

    // The same, as it is asked for most often.
    double size() const { return geometry().size; }
    bool has_cavities() const { return geometry().has_cavities; }
    const Points& pieces() const { return geometry().pieces; }
    const std::vector<char>& pieces_at_support() const { return geometry().pieces_at_support; }
    const Points& skin() const { return geometry().skin; }
    const Eigen::VectorXd& skin_areas() const { return geometry().skin_areas; }
    const Points& material_points() const { return geometry().material_points; }
    const Eigen::VectorXd& material_shares() const { return geometry().material_shares; }
    const Points& support_points() const { return geometry().support_points; }
    const Eigen::VectorXd& support_shares() const { return geometry().support_shares; }

    /// Outward unit normal of the surface near a point, a mean over `radius` [mm]; along z where there is no surface.
    Vec3 normal_near(const Vec3& point, double radius) const {
        const mesh::Surface& surface = geometry().surface;
        return surface.triangles.rows() > 0 ? mesh::mean_normal(surface, point, radius) : Vec3(Vec3::UnitZ());
    }
};

}  // namespace palpate::identify
