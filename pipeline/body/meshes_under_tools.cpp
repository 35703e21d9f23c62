#include "pipeline/body/meshes_under_tools.h"

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/meshing/smooth_surface.h"

namespace palpate::pipeline {
namespace {

double deepest(const std::vector<FineZone>& zones) { return std::ranges::max(zones, {}, &FineZone::radius).radius; }

}  // namespace

MeshesUnderTools::MeshesUnderTools(const identify::MeasurementSet& set, const MeshingOptions& options)
    : surface_(set.rest_surface), tools_(set.tools), options_(options), tree_(surface_) {
    for (const identify::LoadState& state : set.states) {
        const std::vector<FineZone> zones = zones_touched(tools_, state.motions, tree_);
        if (zones.empty()) continue;
        Place* known = find(zones);
        if (!known)
            places_.push_back({zones});
        else if (deepest(zones) > deepest(known->zones))
            known->zones = zones;
    }
}

MeshesUnderTools::Place* MeshesUnderTools::find(const std::vector<FineZone>& zones) {
    const auto same = [](const FineZone& a, const FineZone& b) {
        return (a.at - b.at).norm() < 0.5 * std::max(a.radius, b.radius);
    };
    const auto found =
        std::ranges::find_if(places_, [&](const Place& place) { return std::ranges::equal(place.zones, zones, same); });
    return found == places_.end() ? nullptr : &*found;
}

identify::FinerMesh MeshesUnderTools::at(const std::vector<mesh::ToolMotion>& motions) {
    const std::scoped_lock lock(mutex_);
    const std::vector<FineZone> zones = zones_touched(tools_, motions, tree_);
    Place* place = zones.empty() ? nullptr : find(zones);
    if (!place) return {};
    if (!place->tried) place->finer = make(place->zones);
    place->tried = true;
    return place->finer;
}

identify::FinerMesh MeshesUnderTools::make(const std::vector<FineZone>& zones) const {
    constexpr double hardly = 1.5;  // times finer: it would leave most of the error
    MeshingOptions own = options_;
    own.fine = affordable(zones);
    double times = INFINITY;
    for (const FineZone& zone : own.fine)
        times = std::min(times, edge_at(zone.at, options_.fine, options_.edge_length) / zone.edge);
    if (times < hardly) return {};
    try {
        const MeshedBody body = make_body(surface_, own);
        return {
            std::make_shared<const mesh::VolumeMesh>(mesh::curve_to(body.volume, body.repaired, {.held = own.held})),
            times};
    } catch (const InvalidInput&) {  // too fine for the surface: the error of the other mesh is not told there
    } catch (const SolverFailure&) {
    }
    return {};
}

}  // namespace palpate::pipeline
