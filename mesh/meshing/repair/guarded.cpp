#include "mesh/meshing/repair/guarded.h"

#include "mesh/system/isolated.h"

namespace palpate::mesh {

std::optional<Surface> guarded(Eigen::Index triangles, const std::function<Surface()>& step) {
    ChildResult child =
        run_in_child([&] { return to_bytes(step()); }, limits_for(static_cast<double>(triangles), 1e-3));
    if (child.end != ChildResult::End::Answered) return std::nullopt;
    Surface surface;
    from_bytes(std::move(child.answer), surface);
    if (surface.triangles.rows() == 0) return std::nullopt;
    return surface;
}

}  // namespace palpate::mesh
