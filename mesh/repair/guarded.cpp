#include "mesh/repair/guarded.h"

#include "mesh/io/bytes.h"
#include "mesh/io/child_process.h"

namespace palpate::mesh {

std::optional<Surface> guarded(const std::function<Surface()>& step) {
    ChildResult child = run_in_child(
        [&] {
            const Surface surface = step();
            return to_bytes(surface.vertices, surface.triangles);
        },
        {.seconds = 300, .mebibytes = 8192});
    if (child.end != ChildResult::End::Answered) return std::nullopt;
    Surface surface;
    from_bytes(std::move(child.answer), surface.vertices, surface.triangles);
    if (surface.triangles.rows() == 0) return std::nullopt;
    return surface;
}

}  // namespace palpate::mesh
