#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "identify/measurements/rest_body.h"
#include "identify/measurements/rig/rig_places.h"
#include "identify/numerics/summaries.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// How deep a tool reaches below the surface at rest [mm].
struct DepthAtRest {
    const RestBody& body;
    const mesh::Tool& tool;

    double operator()(const mesh::SphereShape& sphere) const {
        if (!body.is_closed) return 0;
        const double distance = body.tree.closest(tool.origin).distance;
        return sphere.radius + (body.tree.inside(tool.origin) ? distance : -distance);
    }
    double operator()(const mesh::FlatShape& flat) const {
        constexpr int around = 24;
        const Vec3 u = flat.axis.unitOrthogonal(), v = flat.axis.cross(u);
        double deepest = body.depth(tool.origin);
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            const Vec3 to_rim = flat.radius * (std::cos(angle) * u + std::sin(angle) * v);
            for (const double share : {0.5, 1.0}) deepest = std::max(deepest, body.depth(tool.origin + share * to_rim));
        }
        return deepest;
    }
    double operator()(const mesh::SurfaceShape& shape) const {
        double deepest = 0;
        for (const auto& vertex : shape.surface.vertices.rowwise())
            deepest = std::max(deepest, body.depth(vertex.transpose()));
        return deepest;
    }
    double operator()(const mesh::GripShape&) const { return 0; }
};

struct SizeOfShape {
    double operator()(const mesh::SphereShape& sphere) const { return sphere.radius; }
    double operator()(const mesh::FlatShape& flat) const { return flat.radius; }
    double operator()(const mesh::SurfaceShape& shape) const {
        return mesh::bounding_box(shape.surface.vertices).longest_side() / 2;
    }
    double operator()(const mesh::GripShape&) const { return 0; }
};

/// Does a tool in its place reach over a point of the body at rest? Coordinates that are left free count as 0.
class TouchedPlace {
public:
    explicit TouchedPlace(const mesh::Tool& tool) : tool_(tool) {
        if (const auto* shape = std::get_if<mesh::SurfaceShape>(&tool.shape)) tree_.emplace(shape->surface);
    }

    bool holds(const mesh::ToolMotion& motion, const Vec3& point) const {
        const Vec3 moved = known_part(motion.translation), turn = known_part(motion.rotation);
        const double angle = turn.norm();
        const Mat3 R = angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Mat3::Identity();
        // the point as the tool sees it: at rest, about its origin
        return at_rest(R.transpose() * (point - tool_.origin - moved), point);
    }

private:
    bool at_rest(const Vec3& from_origin, const Vec3& point) const {
        if (const auto* sphere = std::get_if<mesh::SphereShape>(&tool_.shape))
            return from_origin.norm() <= sphere->radius;
        if (const auto* flat = std::get_if<mesh::FlatShape>(&tool_.shape)) {
            const double along = from_origin.dot(flat->axis);  // what it has pressed lies behind the disc
            const bool is_behind = along <= 1e-6 * flat->radius && along >= -2 * flat->radius;
            return is_behind && (from_origin - along * flat->axis).norm() <= flat->radius;
        }
        if (tree_) return tree_->inside(tool_.origin + from_origin);
        return mesh::contains(std::get<mesh::GripShape>(tool_.shape).regions, point);
    }

    const mesh::Tool& tool_;
    std::optional<mesh::SurfaceTree> tree_;
};

void check_contacts(const MeasurementSet& set) {
    std::vector<TouchedPlace> places;
    places.reserve(set.tools.size());
    for (const mesh::Tool& tool : set.tools) places.emplace_back(tool);
    for (const LoadState& state : set.states)
        for (const mesh::ToolMotion& motion : state.motions)
            for (const mesh::Contact& contact : state.contacts) {
                const auto t = static_cast<std::size_t>(motion.tool);
                if (!places[t].holds(motion, contact.point)) continue;
                throw InvalidInput(fmt::format(
                    "probes.csv: the force of probe {} at time {} acts at {}, where tool '{}' touches in that "
                    "state: one contact has either its force told or its motion. A force that was measured while the "
                    "tool was moved belongs to reactions.csv.",
                    state.probe, state.time, place_in_words(contact.point), set.tools[t].name));
            }
}

void check_grips(const MeasurementSet& set) {
    for (const mesh::Tool& tool : set.tools) {
        const auto* grip = std::get_if<mesh::GripShape>(&tool.shape);
        if (!grip) continue;
        for (const auto& vertex : set.rest_surface.vertices.rowwise()) {
            const Vec3 place = vertex.transpose();
            if (mesh::contains(grip->regions, place) && mesh::contains(set.supports, place))
                throw InvalidInput(fmt::format(
                    "set.yaml: the material at {} is gripped by tool '{}' and held by a support, and cannot "
                    "be moved and stay. Make their regions apart.",
                    place_in_words(place), tool.name));
        }
    }
}

/// Two grips of one material cannot both move it.
void check_grips_apart(const MeasurementSet& set) {
    for (const LoadState& state : set.states)
        for (std::size_t i = 1; i < state.motions.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const mesh::Tool& one = set.tools[static_cast<std::size_t>(state.motions[i].tool)];
                const mesh::Tool& other = set.tools[static_cast<std::size_t>(state.motions[j].tool)];
                const auto *a = std::get_if<mesh::GripShape>(&one.shape),
                           *b = std::get_if<mesh::GripShape>(&other.shape);
                if (!a || !b) continue;
                for (const auto& vertex : set.rest_surface.vertices.rowwise()) {
                    const Vec3 place = vertex.transpose();
                    if (!mesh::contains(a->regions, place) || !mesh::contains(b->regions, place)) continue;
                    throw InvalidInput(
                        fmt::format("motions.csv: tools '{}' and '{}' both move the material at {} in probe {} at time "
                                    "{}. Make their regions apart.",
                                    other.name, one.name, place_in_words(place), state.probe, state.time));
                }
            }
}

void check_is_answered(MeasurementSet& set, std::size_t t) {
    int moved = 0;
    bool is_answered = false;
    for (const LoadState& state : set.states) {
        if (std::ranges::find(state.motions, static_cast<int>(t), &mesh::ToolMotion::tool) == state.motions.end())
            continue;
        ++moved;
        is_answered = is_answered || !state.readings.empty() || !state.reactions.empty() || !state.field.empty();
    }
    const std::string& name = set.tools[t].name;
    if (moved == 0)
        set.notes.push_back(fmt::format("Tool '{}' is away in all states: motions.csv has no row of it.", name));
    else if (!is_answered)
        throw InvalidInput(
            fmt::format("motions.csv: tool '{}' moves in {} state{}, and nothing was read in any: neither a reaction "
                        "nor a marker. Add what was read (reactions.csv, positions.csv or displacements.csv), or take "
                        "its rows away.",
                        name, moved, moved == 1 ? "" : "s"));
}

/// A ball without friction may turn about its centre as it likes.
void note_turns(MeasurementSet& set) {
    for (std::size_t t = 0; t < set.tools.size(); ++t) {
        const mesh::Tool& tool = set.tools[t];
        if (tool.bonded || !std::holds_alternative<mesh::SphereShape>(tool.shape)) continue;
        const auto turns = [&](const mesh::ToolMotion& motion) {
            return motion.tool == static_cast<int>(t) && !motion.rotation.isZero(0);
        };
        const auto count = std::ranges::count_if(
            set.states, [&](const LoadState& state) { return std::ranges::any_of(state.motions, turns); });
        if (count > 0)
            set.notes.push_back(
                fmt::format("Tool '{}' is a sphere without friction: its turns in {} state{} mean nothing.", tool.name,
                            count, count == 1 ? "" : "s"));
    }
}

/// How far a tool reaches from its origin [mm]; a grip has no body of its own.
struct ReachOfShape {
    const Vec3& origin;

    double operator()(const mesh::SphereShape& sphere) const { return sphere.radius; }
    double operator()(const mesh::FlatShape& flat) const { return flat.radius; }
    double operator()(const mesh::SurfaceShape& shape) const {
        return (shape.surface.vertices.rowwise() - origin.transpose()).rowwise().norm().maxCoeff();
    }
    double operator()(const mesh::GripShape&) const { return std::numeric_limits<double>::infinity(); }
};

/// A tool whose force was read has touched the body: where it is never near, unit or frame are not the body's.
void note_far_tools(MeasurementSet& set) {
    const RestBody body(set.rest_surface);
    const double allowed = 0.05 * body.box.longest_side();  // as for contacts
    for (std::size_t t = 0; t < set.tools.size(); ++t) {
        const mesh::Tool& tool = set.tools[t];
        const double reach = std::visit(ReachOfShape{tool.origin}, tool.shape);
        double nearest = std::numeric_limits<double>::infinity();
        bool is_read = false;
        for (const LoadState& state : set.states) {
            const auto motion = std::ranges::find(state.motions, static_cast<int>(t), &mesh::ToolMotion::tool);
            if (motion == state.motions.end()) continue;
            is_read = is_read || std::ranges::find(state.reactions, static_cast<int>(t), &ReactionReading::tool) !=
                                     state.reactions.end();
            const Vec3 place = tool.origin + known_part(motion->translation);
            nearest = std::min(nearest, body.holds(place) ? 0 : body.tree.closest(place).distance - reach);
        }
        if (is_read && nearest > allowed)
            set.notes.push_back(fmt::format(
                "Tool '{}' comes no nearer than {:.4g} mm to the body at rest, and its force was read: are 'at' in "
                "set.yaml, motions.csv and the body in one unit and one frame?",
                tool.name, nearest));
    }
}

}  // namespace

void check_starts_outside(const mesh::Tool& tool, const mesh::Surface& rest, const std::string& where) {
    constexpr double allowed = 0.02;  // of its radius: facets, and a tool that touches at rest
    const RestBody body(rest);
    const double depth = std::visit(DepthAtRest{body, tool}, tool.shape);
    const double most = allowed * std::visit(SizeOfShape{}, tool.shape);
    if (depth > most)
        throw InvalidInput(fmt::format(
            "{}: tool '{}' starts {:.4g} mm inside the body, {:.4g} mm are allowed. Give the place where it "
            "rests beside the body; motions.csv then tells how far it has moved from there.",
            where, tool.name, depth, most));
}

void check_tools(MeasurementSet& set) {
    check_grips(set);
    check_grips_apart(set);
    check_contacts(set);
    for (std::size_t t = 0; t < set.tools.size(); ++t) check_is_answered(set, t);
    note_turns(set);
    if (!set.tools.empty()) note_far_tools(set);
}

}  // namespace palpate::identify
