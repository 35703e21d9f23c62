#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/types.h"

namespace palpate::identify {

/// A body at rest: its extent, its surface, what it is made of, and where it is held. All members are const and safe
/// from several threads.
class BodyGeometry {
public:
    virtual ~BodyGeometry() = default;

    /// The largest side of the body at rest [mm].
    virtual double size() const = 0;
    /// The model's direction of its surface near a point: outward unit normal.
    virtual Vec3 normal_near(const Vec3& point, double radius) const = 0;
    /// Does the body close in cavities, which can be under pressure?
    virtual bool has_cavities() const = 0;

    /// The pieces that the body is made of, which may be softer or stiffer than the rest: centres (p x 3) [mm].
    virtual const Points& pieces() const = 0;
    /// Pieces that a support's border cuts (p flags).
    virtual const std::vector<char>& pieces_at_support() const = 0;

    /// Points of the surface at rest (s x 3) [mm], and the area that each stands for (s) [mm^2].
    virtual const Points& skin() const = 0;
    virtual const Eigen::VectorXd& skin_areas() const = 0;

    /// Points of the material at rest (n x 3) [mm], and the share of the mass that each stands for (n); they add up to
    /// 1.
    virtual const Points& material_points() const = 0;
    virtual const Eigen::VectorXd& material_shares() const = 0;

    /// Points that the supports hold (s x 3) and their shares (s), which add up to 1.
    virtual const Points& support_points() const = 0;
    virtual const Eigen::VectorXd& support_shares() const = 0;
};

}  // namespace palpate::identify
