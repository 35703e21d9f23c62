#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pipeline/case/subject/subject.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"
#include "pipeline/python/extension/conversions/border.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using identify::LoadState, identify::Reading;

constexpr py::ssize_t number = sizeof(double);

py::object optional_vector(const std::optional<Vec3>& v) {
    if (!v) return py::none();
    return py::make_tuple(v->x(), v->y(), v->z());
}

/// A table (states x markers x width) of readings. `put(row of it, state, place among the state's readings)`.
template <typename Put>
std::vector<double> table_of(const identify::MeasurementSet& set, std::size_t width, Put&& put) {
    const std::size_t row = set.markers.size() * width;
    std::vector<double> table(set.states.size() * row, identify::missing);
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const auto& readings = set.states[s].readings;
        for (std::size_t r = 0; r < readings.size(); ++r) {
            if (readings[r].marker < 0) continue;  // of nobody knows which
            put(table.data() + s * row + static_cast<std::size_t>(readings[r].marker) * width, s, r);
        }
    }
    return table;
}

std::shared_ptr<TabledSet> read_set(const fs::path& path, const Call& call) {
    std::vector<std::string> notes;
    auto set = at_work(call, [&] { return pipeline::read_measurements(path, notes); });
    for (const std::string& note : notes) call.message(static_cast<int>(pipeline::Importance::notice), note);
    return std::make_shared<TabledSet>(std::move(set));
}

py::array of_states(const py::object& self, const std::vector<double>& table, py::ssize_t width) {
    const auto& set = self.cast<const TabledSet&>().set;
    const auto states = std::ssize(set.states), markers = std::ssize(set.markers);
    if (width == 1) return view(table.data(), {states, markers}, {markers * number, number}, self);
    return view(table.data(), {states, markers, width}, {markers * width * number, width * number, number}, self);
}

}  // namespace

std::vector<double> tabled(const identify::MeasurementSet& set, const std::vector<Points>& of_readings) {
    return table_of(set, 3, [&](double* at, std::size_t s, std::size_t r) {
        if (static_cast<Eigen::Index>(r) < of_readings[s].rows())
            Eigen::Map<Vec3>{at} = of_readings[s].row(static_cast<Eigen::Index>(r)).transpose();
    });
}

TabledSet::TabledSet(identify::MeasurementSet given) : set(std::move(given)) {
    rest.resize(std::ssize(set.markers), 3);
    for (std::size_t m = 0; m < set.markers.size(); ++m)
        rest.row(static_cast<Eigen::Index>(m)) = set.markers[m].rest.transpose();
    positions = table_of(set, 3, [&](double* at, std::size_t s, std::size_t r) {
        Eigen::Map<Vec3>{at} = set.states[s].readings[r].position;
    });
    sigma = table_of(set, 1, [&](double* at, std::size_t s, std::size_t r) {
        const double own = set.states[s].readings[r].sigma;
        *at = std::isnan(own) ? set.position_noise.value_or(identify::missing) : own;
    });
    probes.resize(std::ssize(set.states));
    times.resize(std::ssize(set.states));
    Eigen::Index contacts = 0;
    for (const LoadState& state : set.states) contacts += std::ssize(state.contacts);
    contact_states.resize(contacts);
    points.resize(contacts, 3);
    forces.resize(contacts, 3);
    radii.resize(contacts);
    Eigen::Index c = 0;
    for (Eigen::Index s = 0; s < std::ssize(set.states); ++s) {
        const LoadState& state = set.states[static_cast<std::size_t>(s)];
        probes[s] = state.probe;
        times[s] = state.time;
        for (const mesh::Contact& contact : state.contacts) {
            contact_states[c] = static_cast<int>(s);
            points.row(c) = contact.point.transpose();
            forces.row(c) = contact.force.transpose();
            radii[c++] = contact.radius;
        }
    }
}

void bind_sets(py::module_& module) {
    const auto seen = [](auto member) {
        return [member](const py::object& self) { return view(self.cast<const TabledSet&>().*member, self); };
    };
    py::class_<TabledSet, std::shared_ptr<TabledSet>>(
        module, "Set", "Measurements of a body under forces [mm, N, s]; Set.read and Set.from_arrays make one.")
        .def_static("_read", &read_set)
        .def(
            "write",
            [](const TabledSet& s, const fs::path& folder, bool force) {
                pipeline::commands::refuse_to_overwrite(folder, force);
                identify::write_measurement_set(folder, s.set);
            },
            py::arg("folder"), py::arg("force") = false, "Writes the folder that Set.read reads back.")
        .def_property_readonly(
            "name", [](const TabledSet& s) { return s.set.name; }, "as set.yaml tells it")
        .def_property_readonly("markers", seen(&TabledSet::rest), "at rest: (markers, 3) [mm]")
        .def_property_readonly(
            "marker_names",
            [](const TabledSet& s) {
                std::vector<std::string> names;
                for (const auto& marker : s.set.markers) names.push_back(identify::label_of(marker));
                return names;
            },
            "as the files name them")
        .def_property_readonly(
            "positions",
            [](const py::object& self) { return of_states(self, self.cast<const TabledSet&>().positions, 3); },
            "measured: (states, markers, 3) [mm]; NaN where there is no reading")
        .def_property_readonly(
            "sigma", [](const py::object& self) { return of_states(self, self.cast<const TabledSet&>().sigma, 1); },
            "1 sigma of a coordinate: (states, markers) [mm]; NaN where it is not known")
        .def_property_readonly("probes", seen(&TabledSet::probes), "of each state: the probe that it is of (states,)")
        .def_property_readonly("times", seen(&TabledSet::times), "of each state (states,) [s]")
        .def_property_readonly("contact_states", seen(&TabledSet::contact_states),
                               "of each contact: the state that it acts in (contacts,)")
        .def_property_readonly("contact_points", seen(&TabledSet::points), "where they press: (contacts, 3) [mm]")
        .def_property_readonly("contact_forces", seen(&TabledSet::forces), "on the body: (contacts, 3) [N]")
        .def_property_readonly("contact_radii", seen(&TabledSet::radii), "over which they are spread (contacts,) [mm]")
        .def_property_readonly(
            "surface", [](const TabledSet& s) { return std::make_shared<mesh::Surface>(s.set.rest_surface); },
            "of the body at rest, a copy")
        .def_property_readonly(
            "noise", [](const TabledSet& s) { return s.set.position_noise; }, "1 sigma of a coordinate [mm], or None")
        .def_property_readonly(
            "density",
            [](const TabledSet& s) -> std::optional<double> {
                constexpr double kilograms_per_m3 = 1e12;  // in a tonne/mm^3
                if (!s.set.density) return std::nullopt;
                return *s.set.density * kilograms_per_m3;
            },
            "[kg/m^3], or None")
        .def_property_readonly(
            "gravity", [](const TabledSet& s) { return optional_vector(s.set.gravity); },
            "known to act on every state (3) [mm/s^2], or None")
        .def_property_readonly(
            "recordings", [](const TabledSet& s) { return s.set.recordings.size(); },
            "how many there are of the body in motion")
        .def_property_readonly(
            "notes", [](const TabledSet& s) { return s.set.notes; }, "what the files leave open and how it was taken");
}

}  // namespace palpate::python
