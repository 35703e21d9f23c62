#include "pipeline/body/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/meshing/follow_borders.h"
#include "mesh/meshing/refine_surface.h"
#include "mesh/meshing/remesh.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/meshing/tetrahedralise.h"
#include "mesh/regions/interfaces.h"
#include "mesh/topology/check_surface.h"

namespace palpate::pipeline {

namespace {

constexpr double default_edge_share = 0.06;  // of the longest side
constexpr double default_nodes = 20'000;     // that a thin body may have: solved in two seconds

/// The surface with shorter edges where they are wanted, its new vertices where the body is that it was made of.
mesh::Surface refined(const mesh::Surface& surface, const std::vector<FineZone>& zones, double edge,
                      const mesh::Surface& body) {
    if (zones.empty()) return surface;
    // Edges of a remeshed surface are up to 4/3 of what was wanted.
    mesh::Surface result =
        mesh::refine_surface(surface, [&](const Vec3& place) { return edge_at(place, zones, 2 * edge); });
    const mesh::SurfaceTree tree(body);
    for (Eigen::Index v = surface.vertices.rows(); v < result.vertices.rows(); ++v)
        result.vertices.row(v) = tree.closest(result.vertices.row(v)).position;
    return result;
}

/// Elements that end at the borders of what is held; those of a region keep to it.
void follow_borders(MeshedBody& body, const std::vector<mesh::Region>& held, const mesh::Interfaces& interfaces) {
    std::vector<char> fixed(static_cast<std::size_t>(body.surface.vertices.rows()), 0);
    for (const mesh::Surface& interface : interfaces.followed())
        fixed.insert(fixed.end(), static_cast<std::size_t>(interface.vertices.rows()), 1);
    mesh::VolumeMesh volume = mesh::follow_borders(body.volume, held, body.repaired, fixed);
    if (volume.nodes.rows() == body.volume.nodes.rows() && volume.nodes == body.volume.nodes) return;
    body.volume = std::move(volume);
    body.surface = mesh::boundary_surface(body.volume);
}

/// A surface filled with tetrahedra: where that fails with these edges, with shorter ones.
void fill(MeshedBody& body, double edge, const MeshingOptions& options, const Progress& progress) {
    constexpr std::array shares{1.0, 0.8, 0.64};
    for (const double share : shares) {
        try {
            report(progress, "remeshing the surface", 0.3);
            body.surface =
                mesh::remesh(body.repaired, {.edge_length = share * edge, .volume_change = options.volume_change});
            body.surface = refined(body.surface, options.fine, share * edge, body.repaired);
            report(progress, "filling with tetrahedra", 0.6);
            mesh::Interfaces interfaces = mesh::remesh_interfaces(options.regions, body.surface, share * edge);
            body.volume =
                mesh::tetrahedralise_within(body.surface, interfaces.followed(), {.edge_length = share * edge});
            follow_borders(body, options.held, interfaces);
            body.interfaces = std::move(interfaces.surfaces);
            if (share < 1) body.notes.push_back(fmt::format("edges of {:.3g} mm: longer ones failed", share * edge));
            return;
        } catch (const LimitReached&) {
            throw;
        } catch (const SolverFailure&) {
            if (share == shares.back()) throw;
        }
    }
}

}  // namespace

MeshedBody make_body(const mesh::Surface& surface, const MeshingOptions& options, const Progress& progress) {
    MeshedBody body;
    report(progress, "repairing the surface", 0.0);
    const mesh::RepairResult repaired = mesh::repair_surface(surface);
    body.repaired = repaired.surface;
    body.notes = repaired.steps;

    const double longest = mesh::bounding_box(repaired.surface.vertices).longest_side();
    const double edge = options.edge_length > 0 ? options.edge_length : default_edge_length(repaired.surface);
    if (edge > 0.5 * longest) {
        throw InvalidInput(
            fmt::format("edge length {:g} mm is more than half the body's longest side ({:g} mm): choose "
                        "a smaller one, 6 % of it is usual",
                        edge, longest));
    }
    try {
        fill(body, edge, options, progress);
    } catch (const LimitReached&) {
        throw;
    } catch (const SolverFailure& failure) {
        if (repaired.wrapped) throw;
        // Sound, but too thin or too crumpled somewhere to be meshed: the last resort is a wrap.
        try {
            const mesh::RepairResult wrapped = mesh::repair_surface(surface, {.wrap = true});
            body.repaired = wrapped.surface;
            body.notes = wrapped.steps;
            fill(body, edge, options, progress);
        } catch (const InvalidInput&) {
            throw failure;
        }
    }
    if (!options.linear_elements) body.volume = mesh::to_quadratic(body.volume);
    report(progress, "filling with tetrahedra", 1.0);
    return body;
}

MeshedBody ready_made_body(const mesh::VolumeMesh& given, const mesh::Surface& surface, const MeshingOptions& options) {
    if (const mesh::SurfaceReport boundary = mesh::check_surface(surface);
        boundary.non_manifold_edges > 0 || boundary.self_intersections > 0) {
        throw InvalidInput(fmt::format(
            "the boundary of the mesh meets itself along {} edges and crosses itself in {} places, which no body does: "
            "mend it, or give its surface (palpate check tells where), which is repaired and meshed anew",
            boundary.non_manifold_edges, boundary.self_intersections));
    }
    MeshedBody body;
    body.is_ready_made = true;
    for (const mesh::MaterialRegion& region : options.regions) body.interfaces.push_back(region.surface);
    body.repaired = body.surface = surface;
    body.volume = options.linear_elements ? given : mesh::to_quadratic(given);
    body.notes.push_back(fmt::format(
        "the mesh is used as it is: {} tetrahedra of {} nodes{}", given.tetrahedra.rows(), given.tetrahedra.cols(),
        body.volume.is_quadratic() && !given.is_quadratic() ? ", given midside nodes on straight edges" : ""));
    if (options.edge_length > 0) body.notes.emplace_back("an edge length changes nothing on a ready-made mesh");
    return body;
}

std::vector<mesh::MaterialRegion> with_surfaces(std::vector<mesh::MaterialRegion> regions,
                                                const std::vector<mesh::Surface>& interfaces) {
    for (std::size_t r = 0; r < regions.size(); ++r) regions[r].surface = interfaces[r];
    return regions;
}

std::vector<mesh::Region> held_regions(std::vector<mesh::Region> supports, const std::vector<mesh::Tool>& tools) {
    for (const mesh::Tool& tool : tools)
        if (const auto* grip = std::get_if<mesh::GripShape>(&tool.shape))
            supports.insert(supports.end(), grip->regions.begin(), grip->regions.end());
    return supports;
}

double thickness_of(const mesh::Surface& surface) {
    return 2 * std::abs(mesh::signed_volume(surface)) / mesh::area(surface);
}

double edge_of_sheet(const mesh::Surface& surface, double nodes) {
    // A sheet of one element has A / (sqrt(3)/4 h^2) triangles on its surface and some 3.2 nodes for each of them.
    return std::sqrt(3.2 / (std::sqrt(3.0) / 4) * mesh::area(surface) / nodes);
}

double edge_for_thickness(const mesh::Surface& surface, double edge, double nodes) {
    constexpr double slenderest = 4;
    return std::min(edge, std::max(slenderest * thickness_of(surface), edge_of_sheet(surface, nodes)));
}

double default_edge_length(const mesh::Surface& surface) {
    const double usual = default_edge_share * mesh::bounding_box(surface.vertices).longest_side();
    return edge_for_thickness(surface, usual, default_nodes);
}

mesh::BoxRegion default_clamp(const mesh::Box& box) {
    Eigen::Index axis = 0;
    const double longest = box.extent().maxCoeff(&axis);
    const Vec3 margin = Vec3::Constant(0.01 * longest);
    mesh::BoxRegion clamp{box.min - margin, box.max + margin};
    clamp.max[axis] = box.min[axis] + 0.05 * longest;
    return clamp;
}

}  // namespace palpate::pipeline
