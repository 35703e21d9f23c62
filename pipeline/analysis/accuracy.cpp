#include "pipeline/analysis/accuracy.h"

#include <algorithm>
#include <cmath>

#include "fem/elements/patch_load.h"
#include "fem/interpolation/interpolation.h"
#include "mesh/errors.h"
#include "pipeline/body/body.h"
#include "pipeline/case/subject/subject_body.h"

namespace palpate::pipeline {
namespace {

constexpr double coarser = 1.5;  // edges of the second mesh against those of the first
constexpr int most_states = 8;   // a choice of time: each is solved on the second mesh, too

/// Displacements of the markers under each load (3m x loads) [mm].
Eigen::MatrixXd at_markers(const fem::ElasticBody& body, const std::vector<mesh::Contact>& loads, double reach,
                           const Points& markers) {
    const Eigen::MatrixXd u = body.solve(fem::patch_loads(body.mesh(), loads, reach));
    const auto weights = fem::interpolation(body.mesh(), markers);
    Eigen::MatrixXd seen(3 * markers.rows(), u.cols());
    for (Eigen::Index k = 0; k < u.cols(); ++k) {
        const Eigen::Map<const Points> of_nodes(u.col(k).data(), u.rows() / 3, 3);
        seen.col(k) = Points(weights * of_nodes).reshaped<Eigen::RowMajor>();
    }
    return seen;
}

std::vector<mesh::Contact> some_loads(const identify::MeasurementSet& set) {
    std::vector<mesh::Contact> all;
    for (const identify::LoadState& state : set.states)
        if (state.contacts.size() == 1) all.push_back(state.contacts.front());
    const auto count = std::min<std::size_t>(all.size(), most_states);
    std::vector<mesh::Contact> some;
    for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
    return some;
}

}  // namespace

std::optional<ReferenceAccuracy> estimate_accuracy(const Subject& subject, const fem::ElasticBody& body, double edge,
                                                   const identify::MeasurementSet& set) {
    const std::vector<mesh::Contact> loads = some_loads(set);
    if (subject.volume || loads.empty() || set.markers.empty()) return std::nullopt;
    Points markers(static_cast<Eigen::Index>(set.markers.size()), 3);
    for (Eigen::Index m = 0; m < markers.rows(); ++m) markers.row(m) = set.markers[static_cast<std::size_t>(m)].rest;
    const double reach = 0.05 * mesh::bounding_box(set.rest_surface.vertices).longest_side();
    ReferenceAccuracy accuracy{.coarser_edge = coarser * edge};
    try {
        const MeshedBody second = make_body(subject, {.edge_length = accuracy.coarser_edge,
                                                      .linear_elements = !body.mesh().is_quadratic(),
                                                      .volume_change = 0.05});
        accuracy.coarser_nodes = second.volume.nodes.rows();
        const fem::ElasticBody other(second.volume, materials_of(subject, element_regions(subject, second)),
                                     mesh::contains(subject.supports, second.volume.nodes));
        const Eigen::MatrixXd fine = at_markers(body, loads, reach, markers);
        accuracy.difference = (at_markers(other, loads, reach, markers) - fine).norm() / fine.norm();
    } catch (const InvalidInput&) {  // too coarse for this body
        return std::nullopt;
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
    const double order = body.mesh().is_quadratic() ? 2 : 1;
    accuracy.relative = accuracy.difference / (std::pow(coarser, order) - 1);
    return accuracy;
}

}  // namespace palpate::pipeline
