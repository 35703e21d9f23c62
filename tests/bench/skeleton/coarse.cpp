#include "skeleton/coarse.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "fem/elastic_body.h"
#include "fem/elements/patch_load.h"
#include "fem/interpolation/interpolation.h"
#include "mesh/errors.h"
#include "mesh/meshing/remesh.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/meshing/tetrahedralise.h"

namespace palpate::bench {
namespace {

using identify::MeasurementSet;

struct CoarseMesh {
    mesh::VolumeMesh volume;
    std::vector<char> held;  // of each node
    int free = 0;            // nodes
};

/// Do the held nodes stop rigid motion: three that are not in line?
bool are_enough(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    Mat3 spread = Mat3::Zero();
    Vec3 middle = Vec3::Zero();
    double count = 0;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (!held[i]) continue;
        const Vec3 node = mesh.nodes.row(static_cast<Eigen::Index>(i));
        spread += node * node.transpose();
        middle += node;
        ++count;
    }
    if (count < 3) return false;
    spread -= middle * middle.transpose() / count;
    const double size = mesh::bounding_box(mesh.nodes).longest_side();
    return Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues()[1] > 1e-6 * size * size;
}

std::optional<CoarseMesh> mesh_at(const mesh::Surface& surface, const std::vector<mesh::Region>& supports,
                                  double edge) {
    try {
        const mesh::Surface coarse = mesh::remesh(surface, {.edge_length = edge, .volume_change = 0.2});
        CoarseMesh result{mesh::to_quadratic(mesh::tetrahedralise(coarse, {.edge_length = edge})), {}, 0};
        result.held = mesh::contains(supports, result.volume.nodes);
        const auto held = static_cast<int>(std::ranges::count(result.held, 1));
        result.free = static_cast<int>(result.held.size()) - held;
        if (!are_enough(result.volume, result.held)) return std::nullopt;
        return result;
    } catch (const SolverFailure&) {  // too coarse to be sound
        return std::nullopt;
    }
}

/// Bisects for the edge length, as nodes go up where it goes down.
CoarseMesh mesh_with(const mesh::Surface& surface, const std::vector<mesh::Region>& supports, int nodes) {
    const double longest = mesh::bounding_box(surface.vertices).longest_side();
    double low = 0.03 * longest, high = 0.8 * longest;
    std::optional<CoarseMesh> best;
    const auto miss = [&](const CoarseMesh& mesh) { return std::abs(std::log(mesh.free / double(nodes))); };
    for (int trial = 0; trial < 10; ++trial) {
        const double edge = std::sqrt(low * high);
        std::optional<CoarseMesh> mesh = mesh_at(surface, supports, edge);
        (mesh && mesh->free > nodes ? low : high) = edge;
        if (mesh && (!best || miss(*mesh) < miss(*best))) best = std::move(mesh);
        if (best && miss(*best) < 0.05) break;
    }
    if (!best) throw SolverFailure("no coarse mesh is sound");
    return *best;
}

/// Displacements of the markers, a column a state (3m x states) [mm].
Eigen::MatrixXd displacements(const fem::ElasticBody& body, const MeasurementSet& set) {
    std::vector<mesh::Contact> contacts;
    for (const identify::LoadState& state : set.states) {
        contacts.push_back(state.contacts.empty() ? mesh::Contact{} : state.contacts.front());
        if (state.contacts.empty()) contacts.back().point = body.mesh().nodes.row(0);
    }
    const double longest = mesh::bounding_box(body.mesh().nodes).longest_side();
    const Eigen::MatrixXd u = body.solve(fem::patch_loads(body.mesh(), contacts, 0.3 * longest));
    Points rest(static_cast<Eigen::Index>(set.markers.size()), 3);
    for (Eigen::Index m = 0; m < rest.rows(); ++m) rest.row(m) = set.markers[m].rest;
    const auto N = fem::interpolation(body.mesh(), rest);
    Eigen::MatrixXd result(3 * rest.rows(), u.cols());
    for (Eigen::Index s = 0; s < u.cols(); ++s) {
        const Eigen::Map<const Points> field(u.col(s).data(), u.rows() / 3, 3);
        Eigen::Map<Points>(result.col(s).data(), rest.rows(), 3) = N * field;
    }
    return result;
}

Vec3 of_marker(const Eigen::MatrixXd& u, std::size_t state, int marker) {
    return u.col(static_cast<Eigen::Index>(state)).segment<3>(3 * marker);
}

/// The s that makes sum over probes |s v - u|^2 / |u|^2 least, v being the body's and u what was measured.
double best_scale(const MeasurementSet& set, const Eigen::MatrixXd& v) {
    double above = 0, below = 0;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        double uu = 0, uv = 0, vv = 0;
        for (const identify::Reading& reading : set.states[s].readings) {
            const Vec3 u = reading.position - set.markers[reading.marker].rest;
            const Vec3 modelled = of_marker(v, s, reading.marker);
            uu += u.squaredNorm();
            uv += u.dot(modelled);
            vv += modelled.squaredNorm();
        }
        if (uu == 0) continue;
        above += uv / uu;
        below += vv / uu;
    }
    return above / below;
}

}  // namespace

CoarseBody coarse_body(const pipeline::Subject& subject, const pipeline::ProbedQuality& probed, int free_nodes) {
    const mesh::Surface surface = mesh::repair_surface(subject.surface).surface;
    CoarseMesh mesh = mesh_with(surface, subject.supports, free_nodes);
    CoarseBody result;
    result.free_nodes = mesh.free;
    const fem::ElasticBody body(std::move(mesh.volume), subject.material, mesh.held);

    const double scale = best_scale(probed.fit, displacements(body, probed.fit));
    result.scale = 1 / scale;
    const Eigen::MatrixXd u = scale * displacements(body, probed.held_out);
    const MeasurementSet& set = probed.held_out;
    std::vector<Points> predicted;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        Points& positions = predicted.emplace_back(static_cast<Eigen::Index>(set.states[s].readings.size()), 3);
        for (Eigen::Index r = 0; r < positions.rows(); ++r) {
            const int marker = set.states[s].readings[r].marker;
            positions.row(r) = set.markers[marker].rest + of_marker(u, s, marker);
        }
    }
    result.held_out = pipeline::summarise(pipeline::deviations(set, predicted));
    return result;
}

}  // namespace palpate::bench
