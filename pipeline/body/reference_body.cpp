#include "pipeline/body/reference_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fem/material.h"
#include "mesh/errors.h"
#include "mesh/meshing/smooth_surface.h"
#include "mesh/supports/held_parts.h"
#include "pipeline/body/body.h"

namespace palpate::pipeline {
namespace {

constexpr double default_density = 1000;  // [kg/m^3]

std::unique_ptr<identify::ReferenceBody> fill(const identify::MeasurementSet& set, double edge_length,
                                              const Progress& progress, std::vector<std::string>& notes) {
    const double edge = edge_length > 0 ? edge_length : reference_edge_length(set.rest_surface);
    // Tetrahedra that are given stay: those who measured on them, by another solver, made their errors too. Where they
    // are many, fewer are fitted, and what the given ones alter is taken off; unless fewer would bend badly, as those
    // of a body that is thinner than they are long.
    constexpr double most_nodes = 5000;     // fitted: twice those of a body that is meshed for it
    constexpr double enough_nodes = 40000;  // eight times as many, as halved edges make: they have next to no error
    std::optional<MeshedBody> given;
    if (set.rest_volume) given = ready_made_body(*set.rest_volume, set.rest_surface, {});
    const auto given_nodes = given ? static_cast<double>(given->volume.nodes.rows()) : 0;
    const bool is_fitted = given && (given_nodes <= most_nodes || edge > thickness_of(set.rest_surface));
    // Curving the elements gives back what their chords cut off.
    const MeshedBody body =
        is_fitted ? *given
                  : make_body(set.rest_surface,
                              {.edge_length = edge, .fine = contact_zones(set), .volume_change = 0.06}, progress);
    const mesh::VolumeMesh curved = is_fitted ? body.volume : mesh::curve_to(body.volume, body.repaired);
    identify::ReferenceBodyOptions options;
    options.measured_on_mesh = is_fitted;
    if (given && !is_fitted && given_nodes <= enough_nodes) options.finer = given->volume;
    options.rig = {set.tools, set.actuators};
    options.density = set.density.value_or(default_density * fem::tonne_per_mm3);
    if (set.material && set.material->young > 0) options.young = set.material->young;
    if (set.material && !std::isnan(set.material->poisson)) {
        options.poisson = set.material->poisson;
        options.dilatation = dilatation_for(set.rest_surface, edge, *options.poisson);
    }
    if (is_fitted) {
        notes.push_back("The body of the diagnosis is the set's own: " + body.notes.front() + ".");
    } else if (given) {
        notes.push_back(fmt::format(
            "The set's own mesh has {} nodes. The diagnosis fits one of {} nodes, and takes off what {} alter.",
            given->volume.nodes.rows(), curved.nodes.rows(), options.finer ? "the set's own would" : "halved edges"));
    }
    std::ranges::move(mesh::too_little_held(set.supports, curved), std::back_inserter(notes));
    return std::make_unique<identify::ReferenceBody>(curved, set.supports, set.markers, options);
}

}  // namespace

double reference_edge_length(const mesh::Surface& surface) {
    const double longest_side = mesh::bounding_box(surface.vertices).longest_side();
    const double volume = std::abs(mesh::signed_volume(surface));
    // A body of edge length h has about 13.5 V / h^3 nodes, where it is thicker than that.
    constexpr double nodes = 2500;
    const double edge = std::clamp(std::cbrt(13.5 * volume / nodes), 0.07 * longest_side, 0.12 * longest_side);
    return edge_for_thickness(surface, edge, nodes);
}

fem::Dilatation dilatation_for(const mesh::Surface& surface, double edge_length, double poisson) {
    constexpr double unlocked = 0.4;
    return poisson <= unlocked && edge_length > thickness_of(surface) ? fem::Dilatation::full : fem::Dilatation::mean;
}

Reference make_reference(const identify::MeasurementSet& set, double edge_length, const Progress& progress) {
    Reference reference;
    try {
        reference.body = fill(set, edge_length, progress, reference.notes);
    } catch (const InvalidInput& e) {
        reference.why_none = e.what();
    } catch (const SolverFailure& e) {
        reference.why_none = e.what();
    }
    if (reference.body && !set.density) {
        reference.notes.push_back(fmt::format(
            "The density is taken to be {:g} kg/m^3 ('density' in set.yaml says otherwise).", default_density));
    }
    return reference;
}

}  // namespace palpate::pipeline
