#pragma once

#include <mutex>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/models/reference/reference_body.h"
#include "mesh/geometry/surface_tree.h"
#include "pipeline/body/body.h"

namespace palpate::pipeline {

/// Meshes of a set's body, one for each place where tools that are free to part touch it, finer there: what one mesh
/// for all places could not afford.
class MeshesUnderTools {
public:
    /// `options`: of the mesh for all places, with the edges that it has there.
    MeshesUnderTools(const identify::MeasurementSet& set, const MeshingOptions& options);

    /// The mesh for tools that are moved so, made when it is first asked for; none where they do not touch, where it
    /// would be hardly finer, or where nothing can be meshed. May be called by several threads.
    identify::FinerMesh at(const std::vector<mesh::ToolMotion>& motions);

private:
    struct Place {
        std::vector<FineZone> zones;
        identify::FinerMesh finer = {};
        bool tried = false;
    };
    /// The place with the same tools in touch, all within half a zone's radius; null: there is none.
    Place* find(const std::vector<FineZone>& zones);
    identify::FinerMesh make(const std::vector<FineZone>& zones) const;

    mesh::Surface surface_;
    std::vector<mesh::Tool> tools_;
    MeshingOptions options_;
    mesh::SurfaceTree tree_;
    std::vector<Place> places_;
    std::mutex mutex_;
};

}  // namespace palpate::pipeline
