#include "skeleton/runtime/tools/tools.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "skeleton/effects/point_sets.h"

namespace palpate::runtime {

namespace {

/// How far apart the ends of unit quaternions are, up to their sign: half the angle of a small turn between them.
double half_turn(const double* a, const double* b) {
    const Eigen::Map<const Eigen::Vector4d> p(a), q(b);
    return std::min((p - q).norm(), (p + q).norm());
}

}  // namespace

// A wider margin is looked up less often and holds more vertices, which each evaluation visits.
double Tools::Tool::margin() const { return 0.25 * shape->radius(); }

double Tools::Tool::moved() const { return (at - known_at).norm() + extent * (turn - known_turn).norm(); }

fem::Gap Tools::Tool::gap(const Vec3& x) const {
    fem::Gap own = shape->gap(turn.transpose() * (x - at));
    own.normal = turn * own.normal;
    return own;
}

int Tools::add(std::shared_ptr<const fem::RigidShape> shape, double extent, double stiffness) {
    if (skin_.empty()) take_skin();
    Tool& tool = tools_.emplace_back();
    tool.shape = std::move(shape);
    tool.extent = extent;
    tool.stiffness = stiffness;
    tool.near.reserve(skin_.size());
    return count() - 1;
}

void Tools::take_skin() {
    const skeleton::PointSet points = skeleton::point_set(model_, fem::ActsOn::surface);
    carried_.assign(model_.spheres.size(), {});
    for (std::size_t v = 0; v < points.at.size(); ++v) {
        const skeleton::Attachment& vertex = points.at[v];
        skin_.emplace_back().assign(vertex, model_.spheres);
        areas_.push_back(points.weights[static_cast<Eigen::Index>(v)]);
        if (areas_.back() == 0) continue;
        const int sphere = std::ranges::max_element(vertex.shares, {}, &skeleton::SphereInfluence::weight)->sphere;
        carried_[sphere].vertices.push_back(static_cast<int>(v));
        carried_[sphere].reach = std::max(carried_[sphere].reach, (vertex.rest - model_.spheres[sphere].center).norm());
    }
}

void Tools::place(int tool, const Vec3& at, const Mat3& turn) {
    Tool& own = tools_[tool];
    own.is_placed = true;
    own.at = at;
    own.turn = turn;
}

bool Tools::any() const { return std::ranges::any_of(tools_, &Tool::is_placed); }

void Tools::look_up(Tool& tool, const double* pose) {
    constexpr double stretched = 2;  // how much farther out than at rest a vertex may be
    tool.is_known = true;
    tool.known_at = tool.at;
    tool.known_turn = tool.turn;
    tool.near.clear();
    for (std::size_t s = 0; s < carried_.size(); ++s) {
        const double within = tool.extent + tool.margin() + stretched * carried_[s].reach;
        if ((moves_of(pose, static_cast<int>(s)) - tool.at).squaredNorm() > within * within) continue;
        for (const int v : carried_[s].vertices) {
            skin_[v].place(pose);
            if (tool.gap(skin_[v].x()).value < tool.margin()) tool.near.push_back(v);
        }
    }
}

void Tools::keep_known(const double* pose) {
    double moved = INFINITY;  // of any sphere with what it carries
    if (!known_pose_.empty()) {
        moved = 0;
        for (std::size_t s = 0; s < carried_.size(); ++s) {
            const double *now = pose + row_length * s, *then = known_pose_.data() + row_length * s;
            moved = std::max(moved, (Eigen::Map<const Vec3>(now) - Eigen::Map<const Vec3>(then)).norm() +
                                        2 * carried_[s].reach * half_turn(now + 4, then + 4));
        }
    }
    const bool all = std::ranges::any_of(tools_, [&](const Tool& tool) {
        return tool.is_placed && (!tool.is_known || tool.moved() + moved > tool.margin());
    });
    if (!all) return;
    known_pose_.assign(pose, pose + row_length * carried_.size());
    for (Tool& tool : tools_) {
        tool.is_known = false;
        if (tool.is_placed) look_up(tool, pose);
    }
}

/// Calls visit(point, gap, stiffness) of the vertices within a tool; `keep_known` was called at the pose.
template <typename Visit>
void Tools::for_each_touch(Tool& tool, const double* pose, const Visit& visit) {
    if (!tool.is_placed) return;
    for (const int v : tool.near) {
        skin_[v].place(pose);
        const fem::Gap gap = tool.gap(skin_[v].x());
        if (gap.value < 0) visit(skin_[v], gap, tool.stiffness * areas_[v]);
    }
}

void Tools::add_forces(const double* pose, double* force) {
    keep_known(pose);
    for (Tool& tool : tools_) {
        for_each_touch(tool, pose, [&](const RuntimePoint& point, const fem::Gap& gap, double stiffness) {
            point.add_force(-stiffness * gap.value * gap.normal, force);
        });
    }
}

ToolLoad Tools::load(int tool, const double* pose) {
    keep_known(pose);
    ToolLoad sum;
    for_each_touch(tools_[tool], pose, [&](const RuntimePoint& point, const fem::Gap& gap, double stiffness) {
        const Vec3 f = -stiffness * gap.value * gap.normal;
        sum.force += f;
        sum.moment += (point.x() - tools_[tool].at).cross(f);
    });
    return sum;
}

void Tools::press_out(const double* pose, std::vector<float>& skin) {
    keep_known(pose);
    for (const Tool& tool : tools_) {
        if (!tool.is_placed) continue;
        for (const int v : tool.near) {
            Eigen::Map<Eigen::Vector3f> shown(skin.data() + 3L * v);
            const fem::Gap gap = tool.gap(shown.cast<double>());
            if (gap.value < 0) shown -= (gap.value * gap.normal).cast<float>();
        }
    }
}

void Tools::add_rows(const double* pose, StiffRows& stiff) {
    keep_known(pose);
    for (Tool& tool : tools_) {
        for_each_touch(tool, pose, [&](const RuntimePoint& point, const fem::Gap& gap, double stiffness) {
            stiff.add(stiffness, point, gap.normal);
        });
    }
}

}  // namespace palpate::runtime
