#include "pipeline/body/contact_zones.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "identify/numerics/summaries.h"

namespace palpate::pipeline {
namespace {

/// Where a tool stands, in the part of its motion that is told.
Eigen::Isometry3d pose_of(const mesh::Tool& tool, const mesh::ToolMotion& motion) {
    const Vec3 turn = identify::known_part(motion.rotation);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(tool.origin + identify::known_part(motion.translation));
    if (turn.norm() > 0) pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    pose.translate(-tool.origin);
    return pose;
}

/// How far a place is within a body that has not given way [mm], and the nearest of its surface.
struct Depth {
    double within;
    Vec3 surface;
};
Depth depth_of(const Vec3& place, const mesh::SurfaceTree& body) {
    const mesh::SurfacePoint nearest = body.closest(place);
    return {body.inside(place) ? nearest.distance : -nearest.distance, nearest.position};
}

/// Radius of the contact with a ball, a = sqrt(R depth), at most that of the ball. [Hertz]
FineZone under_ball(const Vec3& centre, double radius, const mesh::SurfaceTree& body) {
    const Depth of_centre = depth_of(centre, body);
    const double depth = radius + of_centre.within;
    return {of_centre.surface, std::sqrt(radius * std::clamp(depth, 0.0, radius)), 0};
}

/// A zone as far as the tool reaches; of radius 0 where it does not touch.
FineZone touched(const mesh::Tool& tool, const mesh::ToolMotion& motion, const mesh::SurfaceTree& body) {
    const Eigen::Isometry3d pose = pose_of(tool, motion);
    if (const auto* ball = std::get_if<mesh::SphereShape>(&tool.shape))
        return under_ball(pose * tool.origin, ball->radius, body);
    if (const auto* flat = std::get_if<mesh::FlatShape>(&tool.shape)) {
        const Depth of_face = depth_of(pose * tool.origin, body);
        return {of_face.surface, of_face.within >= 0 || tool.bonded ? flat->radius : 0, 0};
    }
    if (const auto* shape = std::get_if<mesh::SurfaceShape>(&tool.shape)) {
        // As a ball that fits the part which is within.
        FineZone zone;
        double deepest = 0;
        std::vector<Vec3> within;
        for (Eigen::Index v = 0; v < shape->surface.vertices.rows(); ++v) {
            const Depth depth = depth_of(pose * Vec3(shape->surface.vertices.row(v)), body);
            if (depth.within < 0) continue;
            within.push_back(depth.surface);
            if (depth.within >= deepest) zone.at = depth.surface;
            deepest = std::max(deepest, depth.within);
        }
        for (const Vec3& place : within) zone.radius = std::max(zone.radius, (place - zone.at).norm());
        return zone;
    }
    return {};
}

}  // namespace

std::vector<FineZone> zones_touched(const std::vector<mesh::Tool>& tools, const std::vector<mesh::ToolMotion>& motions,
                                    const mesh::SurfaceTree& body) {
    constexpr double edges_over = 2.5;  // a contact's radius
    constexpr double margin = 1.3;      // its border is singular
    std::vector<FineZone> zones;
    for (const mesh::ToolMotion& motion : motions) {
        if (std::holds_alternative<mesh::GripShape>(tools[motion.tool].shape)) continue;
        FineZone zone = touched(tools[motion.tool], motion, body);
        if (zone.radius == 0) continue;
        zone.edge = zone.radius / edges_over;
        zone.radius *= margin;
        zones.push_back(zone);
    }
    return zones;
}

std::vector<FineZone> affordable(std::vector<FineZone> zones) {
    // In all zones together: a choice of cost, as solves grow with the square of the nodes; fewer make contacts
    // coarser.
    constexpr double most_nodes = 6000;
    // Tetrahedra grow slower away from a zone than its surface asks for.
    constexpr double nodes_of_zone = 130;  // (radius / edge)^3, counted on a block
    double nodes = 0;
    for (const FineZone& zone : zones) nodes += nodes_of_zone * std::pow(zone.radius / zone.edge, 3);
    const double longer = std::cbrt(std::max(1.0, nodes / most_nodes));
    for (FineZone& zone : zones) zone.edge *= longer;
    return zones;
}

std::vector<FineZone> contact_zones(const identify::MeasurementSet& set) {
    std::vector<FineZone> zones;
    std::optional<mesh::SurfaceTree> body;
    for (const identify::LoadState& state : set.states) {
        if (state.motions.empty()) continue;
        if (!body) body.emplace(set.rest_surface);
        for (const FineZone& zone : zones_touched(set.tools, state.motions, *body)) {
            const bool is_known = std::ranges::any_of(zones, [&](const FineZone& other) {
                return (other.at - zone.at).norm() < 0.1 * zone.radius &&
                       std::abs(other.radius - zone.radius) < 0.1 * zone.radius;
            });
            if (!is_known) zones.push_back(zone);
        }
    }
    return affordable(std::move(zones));
}

double edge_at(const Vec3& place, const std::vector<FineZone>& zones, double edge) {
    constexpr double growth = 0.8;  // of an edge per length away: a choice; less makes more elements about a zone
    for (const FineZone& zone : zones) {
        const double away = std::max(0.0, (place - zone.at).norm() - zone.radius);
        edge = std::min(edge, zone.edge + growth * away);
    }
    return edge;
}

}  // namespace palpate::pipeline
