#include "pipeline/synthesis/specimen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/loading/twin.h"
#include "identify/models/reference/reference_body.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/meshing/smooth_surface.h"
#include "pipeline/body/body.h"
#include "pipeline/body/contact_zones.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/synthesis/probing/probing.h"
#include "pipeline/synthesis/probing/skeleton_probing.h"
#include "pipeline/synthesis/rig/rig_probes.h"
#include "skeleton/model/link_modulus.h"

namespace palpate::pipeline {
namespace {

constexpr double finer = 0.8;             // edges against those of the body that is fitted: twice the nodes
constexpr double largest_pressure = 0.3;  // under a contact, of Young's modulus
constexpr double chords_cut_off = 0.06;   // of the volume; curving the elements gives it back

/// Do its free spheres stand where its skin is, as in lattices that are all nodes? A measurement set allows 5 %.
bool is_bare(const skeleton::Model& model) {
    if (model.surface.triangles.rows() == 0) return true;
    const mesh::SurfaceTree skin(model.surface);
    const double allowed = 0.05 * mesh::bounding_box(model.surface.vertices).longest_side();
    return std::ranges::all_of(model.spheres, [&](const skeleton::Sphere& sphere) {
        return sphere.held || skin.closest(sphere.center).distance <= allowed;
    });
}

/// Where the rig's tools press.
std::vector<FineZone> zones_of(const RigProbes& driven, const mesh::Surface& surface) {
    identify::MeasurementSet set;
    set.rest_surface = surface;
    set.tools = driven.rig.tools;
    for (const ProbeLoadHistory& history : driven.histories) {
        for (std::size_t row = 0; row < history.rows.size(); ++row) set.states.push_back(history.state(row));
    }
    return contact_zones(set);
}

}  // namespace

Specimen finite_element_specimen(const Subject& subject, const BlindSetOptions& options, const Progress& progress) {
    if (subject.settings.linear_elements) {
        throw InvalidInput("linear elements are too stiff to be the truth; leave --linear-elements out");
    }
    Specimen specimen;
    const double edge = subject.settings.edge_length;
    const double default_edge = subject.volume ? 0 : finer * reference_edge_length(subject.surface);
    const RigProbes driven = rig_probes(subject.surface, subject.supports, options.rig, subject.settings.probing,
                                        subject.settings.identify.seed);
    const MeshedBody body = make_body(subject,
                                      {.edge_length = edge > 0 ? edge : default_edge,
                                       .fine = zones_of(driven, subject.surface),
                                       .held = held_regions({}, driven.rig.tools),
                                       .volume_change = chords_cut_off},
                                      progress);
    specimen.notes = body.notes;
    specimen.volume = body.volume;
    if (!body.is_ready_made) {
        specimen.volume =
            mesh::curve_to(body.volume, body.repaired, {.held = held_regions(subject.supports, driven.rig.tools)});
    }

    identify::MeasurementSet& set = specimen.set;
    set.name = subject.settings.name;
    set.rest_surface = body.repaired;
    set.supports = subject.supports;
    set.density = subject.material.density;
    const ProbeOptions& probing = subject.settings.probing;
    set.markers = spread_markers(body.surface, subject.supports, probing.markers);
    specimen.contacts = probing_contacts(body.surface, subject.supports, probing, subject.settings.identify.seed);
    specimen.driven = driven.histories;
    specimen.notes.insert(specimen.notes.end(), driven.notes.begin(), driven.notes.end());
    set.tools = driven.rig.tools;
    set.actuators = driven.rig.actuators;
    set.regions = subject.regions;

    const fem::Material& material = subject.material;
    specimen.material = material;
    specimen.stiffness = material.young;
    const double radius = specimen.contacts.front().radius;
    specimen.most_force = largest_pressure * material.young * std::numbers::pi * radius * radius;
    specimen.model = std::make_unique<identify::ReferenceBody>(
        specimen.volume, set.supports, set.markers,
        identify::ReferenceBodyOptions{.density = material.density,
                                       .young = material.young,
                                       .dilatation = dilatation_for(body.surface, edge > 0 ? edge : default_edge),
                                       .solver = subject.settings.solver,
                                       .rig = driven.rig,
                                       .regions = with_surfaces(subject.regions, body.interfaces)});
    specimen.setting = {static_cast<int>(options.law.value_or(fem::MaterialLaw::neo_hookean)),
                        Eigen::VectorXd(std::ssize(specimen.model->parameters())),
                        {}};
    for (Eigen::Index p = 0; p < specimen.setting.theta.size(); ++p)
        specimen.setting.theta[p] = specimen.model->parameters()[static_cast<std::size_t>(p)].start;
    specimen.setting.theta.head<2>() = Eigen::Vector2d(std::log(material.young), std::log(1 - 2 * material.poisson));
    return specimen;
}

Specimen skeleton_specimen(const skeleton::Model& model, const ProbeOptions& probing, const BlindSetOptions& options,
                           std::uint64_t seed) {
    if (options.law && *options.law != fem::MaterialLaw::linear) {
        throw InvalidInput(
            "a skeleton has the law of its model.json, or with --linear that of small displacements; "
            "leave --law out");
    }
    if (!options.rig.empty())
        throw InvalidInput("a rig drives a body in finite elements; give a mesh in place of a model.json");
    Specimen specimen;
    identify::MeasurementSet& set = specimen.set;
    set.name = model.name;
    set.rest_surface = model.surface;
    set.supports = model.supports;
    if (is_bare(model)) {
        set.markers = identify::markers_on_spheres(model);
        specimen.contacts = twin_contacts(model, probing, seed);
    } else {
        set.markers = spread_markers(model.surface, model.supports, probing.markers);
        specimen.contacts = probing_contacts(model.surface, model.supports, probing, seed);
    }
    specimen.most_force = std::numeric_limits<double>::infinity();
    specimen.stiffness = skeleton::link_modulus(model);
    const skeleton::EquilibriumLaw law = options.law ? skeleton::EquilibriumLaw::linear : model.law;
    specimen.model = std::make_unique<identify::SkeletonBody>(model, set.markers, specimen.stiffness);
    const Eigen::VectorXd as_told = Eigen::VectorXd::Zero(std::ssize(specimen.model->parameters()));
    specimen.setting = {static_cast<int>(law), as_told, skeleton::physics_of(model.effects)};
    return specimen;
}

}  // namespace palpate::pipeline
