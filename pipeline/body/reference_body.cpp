#include "pipeline/body/reference_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fem/material.h"
#include "identify/loading/tool_motions.h"
#include "mesh/errors.h"
#include "mesh/geometry/local_thickness.h"
#include "mesh/meshing/smooth_surface.h"
#include "mesh/regions/check_regions.h"
#include "mesh/regions/element_regions.h"
#include "mesh/regions/labels.h"
#include "mesh/supports/held_parts.h"
#include "pipeline/body/body.h"
#include "pipeline/body/meshes_under_tools.h"

namespace palpate::pipeline {
namespace {

constexpr double default_density = 1000;  // [kg/m^3]

/// What each region encloses, less the regions within it [mm^3].
std::vector<double> own_volumes(const std::vector<mesh::MaterialRegion>& regions) {
    std::vector<double> whole, own;
    for (const mesh::MaterialRegion& region : regions) whole.push_back(std::abs(mesh::signed_volume(region.surface)));
    own = whole;
    for (std::size_t inner = 0; inner < regions.size(); ++inner) {
        std::optional<std::size_t> parent;
        for (std::size_t outer = 0; outer < regions.size(); ++outer) {
            const bool is_smaller = whole[outer] > whole[inner] && (!parent || whole[outer] < whole[*parent]);
            if (is_smaller && mesh::lies_within(regions[inner].surface, regions[outer].surface)) parent = outer;
        }
        if (parent) own[*parent] -= whole[inner];
    }
    return own;
}

/// Regions whose surfaces elements do not end at, in words: these count as in or out by their centres.
std::vector<std::string> not_followed(const MeshedBody& body, const std::vector<mesh::MaterialRegion>& regions,
                                      bool is_set_s_own) {
    constexpr double allowed = 0.05;  // of a region's volume: stiffness is off by about as much
    if (regions.empty()) return {};
    const std::vector<int> region_of = mesh::regions_of_elements(body.volume, body.interfaces);
    const Eigen::VectorXd volumes = mesh::element_volumes(body.volume);
    std::vector<double> filled(regions.size(), 0.0);
    for (std::size_t e = 0; e < region_of.size(); ++e)
        if (region_of[e] >= 0) filled[static_cast<std::size_t>(region_of[e])] += volumes[static_cast<Eigen::Index>(e)];
    const std::vector<double> enclosed = own_volumes(regions);
    std::vector<std::string> notes;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        if (std::abs(filled[r] - enclosed[r]) <= allowed * enclosed[r]) continue;
        notes.push_back(
            fmt::format("{} not end at the surface of region '{}': those with their centres within fill {:.3g} mm^3 of "
                        "{:.3g} mm^3, and its stiffness may be off by as much. {}",
                        is_set_s_own ? "Elements of the set's mesh do"
                                     : "As it touches that of the body or of another region, elements do",
                        regions[r].name, filled[r], enclosed[r],
                        is_set_s_own ? "The rest surface alone would be meshed along the region."
                                     : "Shorter elements (--edge-length) come closer."));
    }
    return notes;
}

/// The surface filled with tetrahedra, with shorter edges where tools press: as short as `contact_zones` wants them,
/// or, unless the edge length was told, longer, as a diagnosis factors hundreds of tangents, at a cost that grows with
/// the square of the nodes. Enough are about those of a body without tools (`reference_edge_length`: 2,500) and of the
/// zone of one contact. `options`: told those edges, too.
MeshedBody filled(const identify::MeasurementSet& set, MeshingOptions& options, bool is_told,
                  const Progress& progress) {
    constexpr Eigen::Index enough_nodes = 4000;
    constexpr double longer = 1.35, longest = 3;  // edges in zones, at once and in all
    options.fine = contact_zones(set);
    MeshedBody body = make_body(set.rest_surface, options, progress);
    if (is_told || options.fine.empty()) return body;
    for (double all = longer; body.volume.nodes.rows() > enough_nodes && all < longest; all *= longer) {
        for (FineZone& zone : options.fine) zone.edge *= longer;
        body = make_body(set.rest_surface, options, progress);
    }
    return body;
}

std::unique_ptr<identify::ReferenceBody> fill(const identify::MeasurementSet& set, double edge_length,
                                              const Progress& progress,
                                              const std::vector<identify::InformativePrior>& priors,
                                              std::vector<std::string>& notes) {
    const double edge = edge_length > 0 ? edge_length : reference_edge_length(set.rest_surface);
    // Tetrahedra that are given stay: those who measured on them, by another solver, made their errors too. Where they
    // are many, fewer are fitted, and what the given ones alter is taken off; unless fewer would bend badly, as those
    // of a body that is thinner than they are long.
    // fitted: twice those of a body that is meshed for it; four times where they follow materials, as others would not
    const double most_nodes = mesh::labels_of(set.regions).empty() ? 5000 : 10000;
    constexpr double enough_nodes = 40000;  // eight times as many, as halved edges make: they have next to no error
    std::optional<MeshedBody> given;
    if (set.rest_volume) given = ready_made_body(*set.rest_volume, set.rest_surface, {.regions = set.regions});
    const auto given_nodes = given ? static_cast<double>(given->volume.nodes.rows()) : 0;
    const bool is_fitted = given && (given_nodes <= most_nodes || edge > thickness_of(set.rest_surface));
    const std::vector<mesh::Region> held = held_regions(set.supports, set.tools);
    // Curving the elements gives back what their chords cut off.
    MeshingOptions how{.edge_length = edge, .regions = set.regions, .held = held, .volume_change = 0.06};
    const MeshedBody body = is_fitted ? *given : filled(set, how, edge_length > 0, progress);
    const mesh::VolumeMesh curved =
        is_fitted ? body.volume : mesh::curve_to(body.volume, body.repaired, {.held = held});
    identify::ReferenceBodyOptions options;
    options.measured_on_mesh = is_fitted;
    if (given && !is_fitted && given_nodes <= enough_nodes) options.finer = given->volume;
    if (!is_fitted && std::ranges::any_of(set.tools, identify::may_part)) {
        options.finer_under_tools = [meshes = std::make_shared<MeshesUnderTools>(set, how)](const auto& motions) {
            return meshes->at(motions);
        };
    }
    options.dilatation = dilatation_for(body.surface, edge);
    options.rig = {set.tools, set.actuators};
    options.priors = priors;
    options.regions = with_surfaces(set.regions, body.interfaces);
    options.density = set.density.value_or(default_density * fem::tonne_per_mm3);
    if (set.material && set.material->young > 0) options.young = set.material->young;
    if (set.material && !std::isnan(set.material->poisson)) {
        options.poisson = set.material->poisson;
    }
    if (is_fitted) {
        notes.push_back("The body of the diagnosis is the set's own: " + body.notes.front() + ".");
    } else if (given) {
        notes.push_back(fmt::format(
            "The set's own mesh has {} nodes. The diagnosis fits one of {} nodes, and takes off what {} alter.",
            given->volume.nodes.rows(), curved.nodes.rows(), options.finer ? "the set's own would" : "halved edges"));
    }
    std::ranges::move(not_followed(body, set.regions, is_fitted), std::back_inserter(notes));
    std::ranges::move(mesh::too_little_held(set.supports, curved), std::back_inserter(notes));
    return std::make_unique<identify::ReferenceBody>(curved, set.supports, set.markers, options);
}

}  // namespace

double reference_edge_length(const mesh::Surface& surface) {
    const double longest_side = mesh::bounding_box(surface.vertices).longest_side();
    const double volume = std::abs(mesh::signed_volume(surface));
    // A body of edge length h has about 13.5 V / h^3 nodes, where it is thicker than that.
    const double edge =
        std::clamp(std::cbrt(13.5 * volume / reference_nodes), 0.07 * longest_side, 0.12 * longest_side);
    return edge_for_thickness(surface, edge, reference_nodes);
}

fem::Dilatation dilatation_for(const mesh::Surface& surface, double edge_length) {
    // Bars and plates of two elements in thickness are 2 to 5 % too soft by the mean dilatation, as thin ones between 1
    // % too soft and 2 % too stiff; of one element, 13 to 20 % too soft, and between 3 % too soft and 8 % too stiff.
    constexpr double between_one_and_two = 0.6;
    return edge_length > between_one_and_two * mesh::local_thickness(surface) ? fem::Dilatation::thin
                                                                              : fem::Dilatation::mean;
}

Reference make_reference(const identify::MeasurementSet& set, double edge_length, const Progress& progress,
                         const std::vector<identify::InformativePrior>& priors) {
    Reference reference;
    try {
        reference.body = fill(set, edge_length, progress, priors, reference.notes);
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
