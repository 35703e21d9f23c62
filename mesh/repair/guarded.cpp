#include "mesh/repair/guarded.h"

#include "mesh/io/child_process.h"
#include "mesh/io/surface_bytes.h"

namespace palpate::mesh {

std::optional<Surface> guarded(const std::function<Surface()>& step) {
    const ChildResult child = run_in_child([&] { return to_bytes(step()); }, {.seconds = 300, .mebibytes = 8192});
    if (child.end != ChildResult::End::Answered) return std::nullopt;
    Surface surface = surface_from_bytes(child.answer);
    if (surface.triangles.rows() == 0) return std::nullopt;
    return surface;
}

}  // namespace palpate::mesh
