#include "pipeline/analysis/cost/work_size.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "identify/diagnosis/problem.h"
#include "identify/inference/problem/parameters.h"
#include "pipeline/body/body.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/synthesis/probing/probing.h"
#include "skeleton/construction/build.h"
#include "skeleton/construction/properties/skin.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

// Design choices: a count takes seconds.
constexpr double most_nodes = 20000;
constexpr int most_spheres = 300;

/// A body in as many nodes as it will have, or fewer, and how much shorter the edges will be.
struct Sample {
    MeshedBody body;
    double refinement = 1;

    /// How many there will be of what the sample has so many of, `on_surface` of them on its surface.
    double refined(double count, double on_surface) const {
        return refinement * refinement * (on_surface + refinement * (count - on_surface));
    }
};

Sample sample_of(const Subject& subject, const Progress& progress) {
    const Case& c = subject.settings;
    const MeshingOptions options{.edge_length = c.edge_length, .linear_elements = c.linear_elements};
    if (subject.volume) return {make_body(subject, options, progress)};
    const double edge = c.edge_length > 0 ? c.edge_length : default_edge_length(subject.surface);
    // Roughly, a bar of 59,088 nodes has 9.7: no more than the size of the sample depends on it.
    constexpr double nodes_of_a_cube = 7.7;
    const double nodes = nodes_of_a_cube * std::abs(mesh::signed_volume(subject.surface)) / (edge * edge * edge);
    const double coarser = std::max(1.0, std::cbrt(nodes / most_nodes));
    MeshingOptions of_sample = options;
    of_sample.edge_length = coarser * edge;
    return {make_body(subject, of_sample, progress), coarser};
}

/// Nodes of a body on its surface, of which `corners` are corners: by Euler, three edges a corner.
double on_surface(double corners, bool is_quadratic) { return is_quadratic ? 4 * corners : corners; }

double corners_of(const mesh::VolumeMesh& volume) {
    std::vector<char> is_corner(static_cast<std::size_t>(volume.nodes.rows()), 0);
    const Eigen::MatrixX4i corners = volume.tetrahedra.leftCols<4>();
    for (const int node : corners.reshaped()) is_corner[static_cast<std::size_t>(node)] = 1;
    return static_cast<double>(std::ranges::count(is_corner, 1));
}

void count_body(const Subject& subject, const Sample& sample, WorkSize& size) {
    const mesh::VolumeMesh& volume = sample.body.volume;
    const double corners_of_skin = static_cast<double>(sample.body.surface.vertices.rows());
    const double all = static_cast<double>(volume.nodes.rows());
    size.nodes = sample.refined(all, std::min(all, on_surface(corners_of_skin, volume.is_quadratic())));
    size.sample_tetrahedra = static_cast<double>(volume.tetrahedra.rows());
    size.tetrahedra = sample.refined(size.sample_tetrahedra, 0);
    size.skin = sample.refined(corners_of_skin, corners_of_skin);

    const std::vector<char> held = mesh::contains(subject.supports, volume.nodes);
    if (size.is_simulated)
        size.probed =
            fem::forecast_solver(volume, held, size.nodes, subject.settings.probing.probes, subject.settings.solver);
    if (subject.settings.model) return;
    const double corners = corners_of(volume);
    constexpr double quadratic = 7.4;  // nodes for a corner, of linear elements that midside nodes are put into
    size.skeleton_nodes = skeleton::nodes_for_skin(sample.refined(corners, std::min(corners, corners_of_skin)),
                                                   volume.is_quadratic() ? size.nodes : quadratic * size.nodes);
    size.condensed = fem::forecast_solver(volume, held, size.skeleton_nodes, 0, fem::Solver::automatic);
}

void count_skeleton(const Subject& subject, const Sample& sample, WorkSize& size) {
    const Case& c = subject.settings;
    skeleton::Model model;
    double more = 1;  // spheres than the sample's
    if (c.model) {
        model = skeleton::read_model(*c.model);
    } else {
        skeleton::BuildOptions options = c.skeleton;
        if (options.spheres > most_spheres) {
            more = static_cast<double>(options.spheres) / most_spheres;
            options.spheres = most_spheres;
        }
        model = skeleton::build_skeleton(sample.body.surface, sample.body.volume, subject.material, subject.supports,
                                         options);
    }
    const auto parameters = identify::group_stiffness(model, c.identify.scope, c.identify.fixed);
    size.spheres = more * static_cast<double>(model.spheres.size());
    size.links = more * static_cast<double>(model.links.size());
    size.parameters = more * static_cast<double>(parameters.size());
}

void count_measurements(const Subject& subject, WorkSize& size) {
    const ProbeOptions& probing = subject.settings.probing;
    if (!subject.set) {
        size.is_simulated = true;
        size.states = 1 + probing.probes;
        size.markers = probing.markers;
        size.fitted = 1;
        for (int probe = 1; probe <= probing.probes; ++probe) size.fitted += is_held_out(probe, probing) ? 0 : 1;
        return;
    }
    size.states = size.fitted = static_cast<double>(subject.set->states.size());
    size.markers = static_cast<double>(subject.set->markers.size());
}

/// The body that a diagnosis judges on, where the run makes one.
void count_diagnosis(const Subject& subject, WorkSize& size) {
    if (!subject.set || !subject.settings.diagnose.reference) return;
    const Reference reference = make_reference(*subject.set, subject.settings.edge_length);
    if (!reference.body) return;
    size.reference_nodes = static_cast<double>(reference.body->body().mesh().nodes.rows());
    const identify::Problem problem = identify::make_problem(*subject.set, 1);  // no noise is asked of it
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) size.loaded += problem.loaded(k) ? 1 : 0;
}

}  // namespace

WorkSize size_of_run(const Subject& subject, const Progress& progress) {
    WorkSize size;
    count_measurements(subject, size);
    const auto start = std::chrono::steady_clock::now();
    const Sample sample = sample_of(subject, progress);
    size.seconds_to_mesh = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    count_body(subject, sample, size);
    count_skeleton(subject, sample, size);
    count_diagnosis(subject, size);
    return size;
}

}  // namespace palpate::pipeline
