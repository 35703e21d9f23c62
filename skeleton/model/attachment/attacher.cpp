#include <array>

#include "mesh/geometry/surface_tree.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::skeleton {

Attacher::Attacher(const Model& model) : model_(model) {
    if (model.surface.triangles.rows() == 0 || std::ssize(model.skin) != model.surface.vertices.rows()) return;
    tree_ = std::make_unique<mesh::SurfaceTree>(model.surface);
    on_skin_ = 0.02 * mesh::bounding_box(model.surface.vertices).longest_side();
}

Attacher::~Attacher() = default;

Attachment Attacher::operator()(const Vec3& anchor, const Vec3& point) const {
    if (tree_) {
        const mesh::SurfacePoint nearest = tree_->closest(anchor);
        if (nearest.distance <= on_skin_) {
            const auto corners = model_.surface.triangles.row(nearest.triangle);
            std::array<std::pair<double, const Attachment*>, 3> parts;
            for (int c = 0; c < 3; ++c) parts[c] = {nearest.barycentric[c], &model_.skin[corners[c]]};
            return moved_to(blend(parts), point);
        }
    }
    return moved_to(attach_to_links(model_, anchor), point);
}

Attachment attach(const Model& model, const Vec3& point) { return Attacher(model)(point); }

Attachment attach(const Model& model, const Vec3& anchor, const Vec3& point) { return Attacher(model)(anchor, point); }

}  // namespace palpate::skeleton
