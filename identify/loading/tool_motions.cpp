#include "identify/loading/tool_motions.h"

#include <cmath>
#include <type_traits>
#include <variant>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

/// How far a tool reaches from its middle, about [mm]; infinite of one that holds material.
double half_width(const mesh::Tool& tool) {
    const auto of_shape = [](const auto& shape) -> double {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, mesh::SurfaceShape>) {
            return mesh::bounding_box(shape.surface.vertices).longest_side() / 2;
        } else if constexpr (std::is_same_v<Shape, mesh::GripShape>) {
            return INFINITY;
        } else {
            return shape.radius;
        }
    };
    return std::visit(of_shape, tool.shape);
}

}  // namespace

bool may_part(const mesh::Tool& tool) { return !tool.bonded && !std::holds_alternative<mesh::GripShape>(tool.shape); }

bool roams(const mesh::Tool& tool, const mesh::ToolMotion& motion) {
    return may_part(tool) && known_part(motion.translation).norm() > half_width(tool);
}

}  // namespace palpate::identify
