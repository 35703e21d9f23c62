#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::mesh {
class SurfaceTree;
}

namespace palpate::skeleton {

/// On one sphere alone.
Attachment on_sphere(const Model& model, int sphere, const Vec3& rest);

/// Between two spheres, (1 - t) of the one and t of the other: to first order the mean of where each would carry it.
Attachment between(const Model& model, int a, int b, double t, const Vec3& rest);

/// The mean of attachments with weights that add up to 1, as of the corners of a triangle.
Attachment blend(std::span<const std::pair<double, const Attachment*>> parts);

/// The same attachment for a point that is rigidly fixed to that one but stands at `point`.
Attachment moved_to(Attachment attachment, const Vec3& point);

/// On the nearest link's axis or sphere's centre. Distances are measured to the axes, less the radius there (spheres
/// are cones' ends), so that a thick sphere does not lose its skin to a thin neighbour.
Attachment attach_to_links(const Model& model, const Vec3& point);

/// Attaches points to a model: on its skin as the triangle under them, elsewhere to the nearest link or sphere.
class Attacher {
public:
    /// Keeps a reference to the model.
    explicit Attacher(const Model& model);
    ~Attacher();

    Attachment operator()(const Vec3& point) const { return (*this)(point, point); }
    /// The same, for a point that is rigidly fixed to the body at `anchor` but stands at `point`.
    Attachment operator()(const Vec3& anchor, const Vec3& point) const;

private:
    const Model& model_;
    double on_skin_ = 0;                       // so far from the surface a point still counts as on it [mm]
    std::unique_ptr<mesh::SurfaceTree> tree_;  // null without a skin
};

/// One point; for many an Attacher is faster.
Attachment attach(const Model& model, const Vec3& point);
Attachment attach(const Model& model, const Vec3& anchor, const Vec3& point);

}  // namespace palpate::skeleton
