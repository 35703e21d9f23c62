#pragma once

#include "fem/rig/tool_potential.h"
#include "skeleton/effects/point_sets.h"

namespace palpate::skeleton {

/// Stiffness of the layer on a skeleton's skin by which a tool presses, for a body of the modulus `young` [N/mm^3]. A
/// skeleton's skin goes with its spheres, and does not give way under a small tool as the material does: the layer does
/// instead, by as much as an incompressible half-space under a disc of the tool's own radius, a flat punch, or of a
/// third of it, where it is round: k = 2 E* / (pi a). [Sneddon 1965; a layer as Winkler has it]
double layer_stiffness(const mesh::Tool& tool, double young);

/// A tool that may part, as a skeleton feels it. A point may be deep in the layer, where fem::ToolPotential leaves the
/// curvature of the tool's shape out: here it counts, by central differences of the gradient.
class LayeredTool final : public fem::PointPotential {
public:
    explicit LayeredTool(std::shared_ptr<const fem::ToolPotential> tool) : tool_(std::move(tool)) {}
    fem::ActsOn acts_on() const override { return tool_->acts_on(); }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override;
    bool is_one_sided() const override { return true; }

private:
    std::shared_ptr<const fem::ToolPotential> tool_;
};

/// The points of a skeleton that a tool may touch, or holds, weighed by how stiffly [N/mm]; those that it never feels
/// are left out.
///   a shape that may part: the skin's vertices, by `layer_stiffness` and their area
///   a bonded one: the skin's vertices, as fem::ToolPotential weighs them
///   a grip: the skin's vertices in its regions, and of each sphere with its centre there the six points where the axes
///     meet it, so that it is kept from turning
/// @throws InvalidInput as fem::ToolPotential::weights, or where a shape meets a model without a skin.
PointSet tool_points(const Model& model, const fem::ToolPotential& tool);

}  // namespace palpate::skeleton
