#include "pipeline/synthesis/probing/probing.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/elements/patch_load.h"
#include "fem/interpolation/interpolation.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/geometry/sampling.h"

namespace palpate::pipeline {
namespace {

using identify::LoadState;
using identify::MeasurementSet;

/// Surface vertices that may be touched: the patch keeps clear of the supports.
std::vector<int> free_vertices(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                               double clearance) {
    const std::vector<char> held = mesh::contains(supports, surface.vertices);
    std::vector<int> held_ids;
    for (int v = 0; v < surface.vertices.rows(); ++v) {
        if (held[v]) held_ids.push_back(v);
    }
    std::vector<int> free;
    for (int v = 0; v < surface.vertices.rows(); ++v) {
        const bool clear = std::none_of(held_ids.begin(), held_ids.end(), [&](int h) {
            return (surface.vertices.row(h) - surface.vertices.row(v)).norm() < clearance;
        });
        if (!held[v] && clear) free.push_back(v);
    }
    return free;
}

/// Push in, pull out, and two ways sideways, in turn.
Vec3 probing_direction(int probe, const Vec3& normal, std::mt19937_64& random) {
    if (probe % 4 == 0) return -normal;
    if (probe % 4 == 2) return normal;
    const double angle = std::uniform_real_distribution<double>(0.0, 2 * std::numbers::pi)(random);
    const Vec3 first = normal.unitOrthogonal();
    return std::cos(angle) * first + std::sin(angle) * normal.cross(first);
}

/// Scale of each unit-load state: largest displacement as asked, pressure under the patch at most 0.3 E.
Eigen::VectorXd load_scales(const Eigen::MatrixXd& unit_displacements, double wanted, double radius, double young) {
    constexpr double largest_pressure = 0.3;  // of E
    const double largest_force = largest_pressure * young * std::numbers::pi * radius * radius;
    Eigen::VectorXd scales(unit_displacements.cols());
    for (Eigen::Index p = 0; p < scales.size(); ++p) {
        const Eigen::Map<const Points> u(unit_displacements.col(p).data(), unit_displacements.rows() / 3, 3);
        scales[p] = std::min(wanted / u.rowwise().norm().maxCoeff(), largest_force);
    }
    return scales;
}

void read_markers(MeasurementSet& set, const mesh::VolumeMesh& mesh, const Eigen::MatrixXd& displacements, double noise,
                  std::mt19937_64& random) {
    Points rest(static_cast<Eigen::Index>(set.markers.size()), 3);
    for (Eigen::Index m = 0; m < rest.rows(); ++m) rest.row(m) = set.markers[m].rest;
    const auto weights = fem::interpolation(mesh, rest);
    std::normal_distribution<double> gauss(0.0, 1.0);
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const Eigen::Map<const Points> u(displacements.col(s).data(), displacements.rows() / 3, 3);
        Points positions = rest + weights * u;
        if (noise > 0) positions = positions.unaryExpr([&](double x) { return x + noise * gauss(random); });
        for (int m = 0; m < static_cast<int>(rest.rows()); ++m) {
            set.states[s].readings.push_back({m, positions.row(m).transpose(), identify::missing});
        }
    }
}

}  // namespace

std::vector<mesh::Contact> probing_contacts(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                                            const ProbeOptions& options, std::uint64_t seed) {
    options.validate();
    const double radius = options.radius * mesh::bounding_box(surface.vertices).longest_side();
    const std::vector<int> free = free_vertices(surface, supports, 1.2 * radius);
    if (free.empty()) {
        throw InvalidInput(
            fmt::format("no surface is left to probe: all of it lies within {:.3g} mm (1.2 contact radii) of a "
                        "support; make the supports or the contact radius smaller",
                        1.2 * radius));
    }
    std::mt19937_64 random(seed);
    const Points candidates = surface.vertices(free, Eigen::all);
    const Points normals = mesh::vertex_normals(surface);
    const auto first = std::uniform_int_distribution<int>(0, static_cast<int>(free.size()) - 1)(random);
    std::vector<mesh::Contact> contacts;
    const std::vector<int> sites = mesh::farthest_points(candidates, options.probes, first);
    for (int p = 0; p < options.probes; ++p) {
        const int site =
            sites[static_cast<std::size_t>(p) % sites.size()];  // more probes than vertices: again, otherwise directed
        contacts.push_back({candidates.row(site).transpose(),
                            probing_direction(p, normals.row(free[site]).transpose(), random), radius});
    }
    return contacts;
}

std::vector<identify::Marker> spread_markers(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                                             int count) {
    const std::vector<char> held = mesh::contains(supports, surface.vertices);
    std::vector<int> free;
    for (int v = 0; v < surface.vertices.rows(); ++v) {
        if (!held[v]) free.push_back(v);
    }
    const Points candidates = surface.vertices(free, Eigen::all);
    std::vector<identify::Marker> markers;
    for (const int chosen : mesh::farthest_points(candidates, count)) {
        markers.push_back({static_cast<int>(markers.size()), candidates.row(chosen).transpose(), {}});
    }
    return markers;
}

ProbedBody probe_body(const fem::ElasticBody& body, const mesh::Surface& surface,
                      const std::vector<mesh::Region>& supports, const ProbeOptions& options, std::uint64_t seed,
                      const Progress& progress) {
    ProbedBody probed;
    MeasurementSet& set = probed.set;
    set.rest_surface = surface;
    set.supports = supports;
    set.density = body.materials().body.density;
    set.material = identify::MaterialGuess{body.materials().body.young, body.materials().body.poisson};
    if (options.noise > 0) set.position_noise = options.noise;

    std::vector<mesh::Contact> contacts = probing_contacts(surface, supports, options, seed);
    report(progress, "reference deformations", 0.1);
    const double longest = mesh::bounding_box(surface.vertices).longest_side();
    Eigen::MatrixXd unit = body.solve(fem::patch_loads(body.mesh(), contacts, 0.05 * longest));
    report(progress, "reference deformations", 0.9);
    const Eigen::VectorXd scales = load_scales(unit, options.largest_displacement(true) * longest,
                                               contacts.front().radius, body.materials().body.young);
    probed.displacements.resize(unit.rows(), unit.cols() + 1);
    probed.displacements << Eigen::VectorXd::Zero(unit.rows()), unit * scales.asDiagonal();

    set.states.push_back({.probe = 0, .time = 0});
    for (int p = 0; p < options.probes; ++p) {
        contacts[p].force *= scales[p];
        set.states.push_back({.probe = p + 1, .time = 0, .contacts = {contacts[p]}});
    }
    set.markers = spread_markers(surface, supports, options.markers);
    std::mt19937_64 random(seed ^ 0x9e3779b97f4a7c15ULL);  // apart from the contacts' numbers
    read_markers(set, body.mesh(), probed.displacements, options.noise, random);
    report(progress, "reference deformations", 1.0);
    return probed;
}

bool is_held_out(int probe, const ProbeOptions& options) {
    if (options.held_out == 0 || probe == 0) return false;
    const auto share = [&](int p) { return p * options.held_out / options.probes; };
    return share(probe) > share(probe - 1);
}

void write_probed_body(const std::filesystem::path& folder, const ProbedBody& probed, const mesh::VolumeMesh& body) {
    identify::write_measurement_set(folder, probed.set, [&](const std::filesystem::path& temporary) {
        for (std::size_t s = 0; s < probed.set.states.size(); ++s) {
            const Eigen::Map<const Points> u(probed.displacements.col(s).data(), probed.displacements.rows() / 3, 3);
            const LoadState& state = probed.set.states[s];
            mesh::write_vtu(temporary / "field" / fmt::format("{}_{}.vtu", state.probe, state.time), body,
                            {.points = {{"displacement", u}}});
        }
    });
}

}  // namespace palpate::pipeline
