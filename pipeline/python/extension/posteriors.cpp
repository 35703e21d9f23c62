#include "pipeline/python/extension/posteriors.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pipeline/analysis/particles.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/results/identification.h"
#include "pipeline/output/text/identification.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using identify::IdentifyResult;

Posterior posterior_of(const IdentifyResult& found) {
    Posterior posterior{.rows = found.posterior, .draws = {}, .weights = {}};
    if (found.history.empty()) return posterior;
    posterior.draws = found.history.back().particles;
    posterior.weights = found.history.back().log_weights.array().exp();
    posterior.weights /= posterior.weights.sum();
    return posterior;
}

Posterior read_folder(const fs::path& folder) {
    Posterior posterior{.rows = pipeline::read_posterior(folder / "posterior.csv"), .draws = {}, .weights = {}};
    if (!fs::exists(folder / "particles.csv")) return posterior;
    pipeline::ParticleSet particles = pipeline::read_particles(folder / "particles.csv");
    posterior.draws = std::move(particles.stiffness);
    posterior.weights = std::move(particles.weights);
    return posterior;
}

template <typename T>
auto column(T identify::PosteriorRow::*member) {
    return [member](const Posterior& p) {
        std::vector<T> values;
        for (const auto& row : p.rows) values.push_back(row.*member);
        return values;
    };
}

}  // namespace

void bind_posteriors(py::module_& module) {
    using identify::PosteriorRow;
    py::class_<Posterior, std::shared_ptr<Posterior>>(
        module, "Posterior", "Stiffnesses that the measurements leave possible, as weighted draws.")
        .def_static(
            "read", [](const fs::path& folder) { return std::make_shared<Posterior>(read_folder(folder)); },
            py::arg("folder"), "Reads posterior.csv and particles.csv of a folder.")
        .def_property_readonly(
            "draws", [](const py::object& self) { return view(self.cast<const Posterior&>().draws, self); },
            "(draws, parameters), in their units; weighted")
        .def_property_readonly(
            "weights", [](const py::object& self) { return view(self.cast<const Posterior&>().weights, self); },
            "(draws,), they add up to 1")
        .def_property_readonly("parameters", column(&PosteriorRow::parameter),
                               "'elongation', 'flexion:zone2', 'torsion:link17'")
        .def_property_readonly("links", column(&PosteriorRow::link), "that it is of; -1: of several")
        .def_property_readonly("units", column(&PosteriorRow::unit), "of the parameters")
        .def_property_readonly("_mean", column(&PosteriorRow::mean))
        .def_property_readonly("_sd", column(&PosteriorRow::sd))
        .def_property_readonly("_q025", column(&PosteriorRow::q025))
        .def_property_readonly("_q50", column(&PosteriorRow::q50))
        .def_property_readonly("_q975", column(&PosteriorRow::q975))
        .def_property_readonly("_prior_mean", column(&PosteriorRow::prior_mean))
        .def_property_readonly("_prior_sd", column(&PosteriorRow::prior_sd))
        .def_property_readonly("_informed", column(&PosteriorRow::informed));

    py::class_<IdentifyResult, std::shared_ptr<IdentifyResult>>(
        module, "Identification", "What identify found: a model, its posterior, and how the fit went.")
        .def_property_readonly(
            "model",
            [](const py::object& self) {
                // The result's own, which lives as long as the model is seen.
                auto found = self.cast<std::shared_ptr<IdentifyResult>>();
                return SharedModel(found, &found->model);
            },
            "with the most probable stiffness; the result's own")
        .def_property_readonly(
            "posterior", [](const IdentifyResult& r) { return std::make_shared<Posterior>(posterior_of(r)); },
            "of its parameters")
        .def_property_readonly(
            "summary", [](const IdentifyResult& r) { return as_python(pipeline::summary_json(r)); },
            "what identify.json says")
        .def_property_readonly(
            "notes", [](const IdentifyResult& r) { return r.notes; }, "what you should know, in words")
        .def_property_readonly(
            "log_evidence", [](const IdentifyResult& r) { return r.log_evidence; }, "ln of the evidence")
        .def("__str__", [](const IdentifyResult& r) { return pipeline::identification_in_words(r); })
        .def(
            "write",
            [](const IdentifyResult& r, const fs::path& folder, bool force) {
                pipeline::commands::refuse_to_overwrite(folder, force);
                pipeline::write_identification(folder, r);
            },
            py::arg("folder"), py::arg("force") = false, "Writes what `palpate identify -o folder` does.");
}

}  // namespace palpate::python
