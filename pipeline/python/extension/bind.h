#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "identify/measurements/measurement_set.h"
#include "mesh/core/surface.h"
#include "mesh/core/volume_mesh.h"
#include "skeleton/model/model.h"

// The parts of the module `palpate._core`, a file each.

namespace palpate::python {

namespace py = pybind11;

using SharedSurface = std::shared_ptr<mesh::Surface>;
using SharedMesh = std::shared_ptr<mesh::VolumeMesh>;
using SharedModel = std::shared_ptr<skeleton::Model>;

/// A measurement set, with its readings as one table as numpy wants them.
struct TabledSet {
    explicit TabledSet(identify::MeasurementSet given);

    identify::MeasurementSet set;
    Points rest;                           // of markers (m x 3) [mm]
    std::vector<double> positions, sigma;  // (states x markers x 3), (states x markers); NaN: missing [mm]
    Eigen::VectorXi probes;                // of states
    Eigen::VectorXd times;                 // of states [s]
    Eigen::VectorXi contact_states;        // of contacts: the state that it is of
    Points points, forces;                 // of contacts (c x 3) [mm, N]
    Eigen::VectorXd radii;                 // of contacts [mm]
};

/// Where predicted readings of each state, in the order of these, stand in the set's table (states x markers x 3).
std::vector<double> tabled(const identify::MeasurementSet& set, const std::vector<Points>& of_readings);

inline py::object as_python(const nlohmann::json& json) {
    return py::module_::import("json").attr("loads")(json.dump());
}

void bind_meshes(py::module_& module);
void bind_sets(py::module_& module);
void bind_models(py::module_& module);
void bind_posteriors(py::module_& module);
void bind_commands(py::module_& module);
void bind_commands_on_objects(py::module_& module);
void bind_bodies(py::module_& module);
void bind_effects(py::module_& module);

}  // namespace palpate::python
