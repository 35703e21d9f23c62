#include "mesh/meshing/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mesh/errors.h"
#include "mesh/meshing/repair/steps.h"
#include "mesh/system/isolated.h"
#include "mesh/topology/cgal_mesh.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/creases.h"

namespace palpate::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using cgal::Mesh;
using Edge = Mesh::Edge_index;
using Face = Mesh::Face_index;
using Vertex = Mesh::Vertex_index;

constexpr int attempts = 7;
constexpr double usual_edge = 0.06;  // over the longest side
// The next length aims at this share of the volume's change that is allowed, but is no less than so much of the last,
// which may have told it badly, and shorter at least by a tenth, or a fourth where the triangles crossed.
constexpr double aimed_change = 0.8, shortest_next = 0.4, longest_next = 0.9, longest_after_crossing = 0.75;
constexpr std::array widths_left{0.5, 1.0, 2.0, 3.0};  // edges round a crossing, tried in turn: fewest stay as they are
constexpr double most_triangles = 100'000;             // more would make a body that nobody can compute with

/// What one attempt came to.
struct Attempt {
    Surface surface;
    double volume_change = 1;     // as a share of the volume
    bool sound = false;           // closed, outward, without crossings, no part or handle more or less
    std::vector<Vec3> crossings;  // where new triangles cross, of one that is not sound [mm]
};

/// Number of parts, and Euler's characteristic V - E + F.
std::pair<int, int> topology(const SurfaceReport& report) {
    return {report.components, report.vertices - report.triangles / 2};
}

/// What must not change.
struct Fixed {
    Creases creases;
    std::vector<char> triangles;  // which of the surface stay as they are
};

Attempt attempt(const Surface& surface, const Fixed& fixed, double length, int iterations) {
    Mesh mesh = cgal::to_mesh(cgal::to_soup(surface));
    const auto crease = mesh.add_property_map<Edge, bool>("e:crease", false).first;
    const auto corner = mesh.add_property_map<Vertex, bool>("v:corner", false).first;
    for (const auto& [a, b] : fixed.creases.edges) {
        const auto h = mesh.halfedge(Vertex(static_cast<Mesh::size_type>(a)), Vertex(static_cast<Mesh::size_type>(b)));
        if (h.is_valid()) crease[mesh.edge(h)] = true;
    }
    for (const int v : fixed.creases.corners) corner[Vertex(static_cast<Mesh::size_type>(v))] = true;

    std::vector<Face> faces;
    for (const Face f : mesh.faces())
        if (!fixed.triangles[f.idx()]) faces.push_back(f);

    pmp::isotropic_remeshing(faces, length, mesh,
                             CGAL::parameters::number_of_iterations(static_cast<unsigned>(iterations))
                                 .edge_is_constrained_map(crease)
                                 .vertex_is_constrained_map(corner)
                                 .number_of_relaxation_steps(3));
    Attempt result;
    result.surface = cgal::from_mesh(mesh);
    const auto keep_if_sound = [&](const Surface& candidate, std::vector<FaultPlace>* places = nullptr) {
        const SurfaceReport report = check_surface(candidate, places);
        if (!report.sound() || topology(report) != topology(check_surface(surface))) return;
        result.surface = candidate;
        result.sound = true;
    };
    std::vector<FaultPlace> places;
    keep_if_sound(result.surface, &places);
    for (const FaultPlace& place : places) result.crossings.push_back(place.at);
    if (!result.sound) keep_if_sound(remove_crossings(result.surface));
    const double volume = signed_volume(surface);
    result.volume_change = std::abs(signed_volume(result.surface) - volume) / volume;
    return result;
}

/// Triangles near to where new ones cross stay as they are from now on: walls there are thinner than new edges are
/// long.
void fix_near(const std::vector<Vec3>& crossings, double reach, const Surface& surface, Fixed& fixed) {
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        char& is_fixed = fixed.triangles[static_cast<std::size_t>(t)];
        for (const int v : surface.triangles.row(t)) {
            const Vec3 corner = surface.vertices.row(v);
            if (is_fixed) break;
            is_fixed = std::ranges::any_of(crossings, [&](const Vec3& at) { return (corner - at).norm() < reach; });
        }
    }
}

/// At one length: as few triangles of the surface stay as they are as make the result sound.
Attempt attempt_around_thin_places(const Surface& surface, const Creases& creases, double length, int iterations) {
    Fixed fixed{creases, std::vector<char>(static_cast<std::size_t>(surface.triangles.rows()), 0)};
    Attempt tried = attempt(surface, fixed, length, iterations);
    for (const double reach : widths_left) {
        if (tried.sound || tried.crossings.empty()) break;
        fix_near(tried.crossings, reach * length, surface, fixed);
        tried = attempt(surface, fixed, length, iterations);
    }
    return tried;
}

std::string reason(const Attempt& tried, double allowed) {
    if (!tried.sound) return "the new triangles cross each other";
    return fmt::format("the volume changes by {:.1f} % (allowed: {:.0f} %)", 100 * tried.volume_change, 100 * allowed);
}

double target_length(const Surface& surface, const RemeshOptions& options) {
    return options.edge_length > 0 ? options.edge_length : usual_edge * bounding_box(surface.vertices).longest_side();
}

double triangles_of(const Surface& surface, double length) {
    return area(surface) / (std::sqrt(3.0) / 4 * length * length);
}

Surface remeshed(const Surface& surface, const RemeshOptions& options) {
    if (surface.triangles.rows() == 0 || !cgal::is_mesh(cgal::to_soup(surface)) || !(signed_volume(surface) > 0))
        throw InvalidInput("Remeshing: the surface is not closed and outward. Repair it first.");
    const double target = target_length(surface, options);
    const Creases creases = find_creases(surface, options.crease_angle);

    // Chords cut volume off in proportion to their length squared: that tells the next length to try.
    double length = target;
    std::string last;
    for (int i = 0; i < attempts; ++i) {
        if (const double triangles = triangles_of(surface, length); triangles > most_triangles) {
            last += fmt::format("{}at {:.4g} mm there would be {:.0f} triangles ({:.0f} are allowed)",
                                last.empty() ? "" : ", and ", length, triangles, most_triangles);
            break;
        }
        const Attempt tried = attempt_around_thin_places(surface, creases, length, options.iterations);
        if (tried.sound && tried.volume_change <= options.volume_change) return tried.surface;
        last = fmt::format("at {:.4g} mm {}", length, reason(tried, options.volume_change));
        const double wanted = std::sqrt(aimed_change * options.volume_change / std::max(tried.volume_change, 1e-12));
        length *= std::clamp(wanted, shortest_next, tried.sound ? longest_next : longest_after_crossing);
    }
    throw SolverFailure(
        fmt::format("Remeshing found no sound triangles for an edge length of {:.4g} mm: {}. Thicken or "
                    "remove its thinnest places, or give another edge length.",
                    target, last));
}

}  // namespace

void RemeshOptions::validate() const {
    if (!(edge_length >= 0 && std::isfinite(edge_length)))
        throw InvalidInput(
            fmt::format("Remeshing: edge_length is {} mm; a positive length is allowed, or 0 for 0.06 of "
                        "the longest side.",
                        edge_length));
    if (!(crease_angle > 0 && crease_angle < 180))
        throw InvalidInput(fmt::format(
            "Remeshing: crease_angle is {} degrees; more than 0 and less than 180 is allowed.", crease_angle));
    if (!(volume_change > 0 && volume_change <= 0.2))
        throw InvalidInput(
            fmt::format("Remeshing: volume_change is {}; more than 0 and at most 0.2 is allowed.", volume_change));
    if (iterations < 1 || iterations > 100)
        throw InvalidInput(fmt::format("Remeshing: iterations is {}; 1 to 100 is allowed.", iterations));
}

Surface remesh(const Surface& surface, const RemeshOptions& options) {
    options.validate();
    if (surface.triangles.rows() == 0) throw InvalidInput("Remeshing: the surface has no triangles.");
    const double triangles = static_cast<double>(surface.triangles.rows()) +
                             std::min(triangles_of(surface, target_length(surface, options)), most_triangles);
    constexpr double seconds_each = 0.01;  // seven lengths, five tries each, at 50 us a triangle and iteration
    return isolated_as<Surface>("Remeshing", "Simplify the surface in a mesh editor, or give a larger edge length.",
                                limits_for(triangles, seconds_each), [&] { return remeshed(surface, options); });
}

}  // namespace palpate::mesh
