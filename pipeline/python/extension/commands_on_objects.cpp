#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "identify/measurements/files/read_markers.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/forecast/forecast.h"
#include "pipeline/command_line/objects.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"
#include "pipeline/python/extension/conversions/border.h"
#include "pipeline/python/extension/conversions/overrides.h"

// The commands that take a model and a set, on objects; and bodies and skeletons as objects.

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
namespace commands = pipeline::commands;
using pipeline::Console;

/// A list of doubles as an array of its own memory.
py::array owned(std::vector<double> values, const std::vector<py::ssize_t>& shape) {
    auto* kept = new std::vector<double>(std::move(values));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<double>*>(p); });
    return py::array(py::dtype::of<double>(), shape, kept->data(), owner);
}

py::array predicted_of(const identify::MeasurementSet& set, const identify::Comparison& comparison) {
    return owned(tabled(set, comparison.predicted), {std::ssize(set.states), std::ssize(set.markers), 3});
}

py::tuple skeleton_of(const fs::path& input, const Overrides& settings, const Call& call) {
    auto built = at_work(call, [&] {
        const commands::BuiltBody body = commands::build_body(input, overrides_of(settings, call));
        return commands::build_skeleton(body);
    });
    const py::dict report(py::arg("coverage_mm") = built.report.coverage, py::arg("notes") = built.report.notes);
    return py::make_tuple(std::make_shared<skeleton::Model>(std::move(built.model)), report);
}

py::tuple compare(const skeleton::Model& model, const TabledSet& set, const fs::path& output, bool reference,
                  const Overrides& settings, const Call& call) {
    const commands::CompareOptions options{.model = {},
                                           .set = {},
                                           .output = output,
                                           .tolerance = {},
                                           .no_reference = !reference,
                                           .overrides = overrides_of(settings, call)};
    const auto compared = at_work(call, [&] {
        if (!output.empty()) commands::refuse_to_overwrite(output, call.common.force);
        const auto given = commands::put_together(model, set.set, set.set.name);
        auto found = commands::compare(given, options, call.common);
        if (!output.empty()) {
            pipeline::write_played_series(output, given.model, found.set, found.comparison);
            mesh::write_text(output / "compare.json", found.json.dump(2) + "\n");
        }
        return found;
    });
    return py::make_tuple(pipeline::compare_in_words(compared.json), as_python(compared.json),
                          predicted_of(compared.set, compared.comparison));
}

py::tuple diagnose(const skeleton::Model& model, const TabledSet& set, const fs::path& output,
                   const std::vector<std::string>& without, const std::string& body, const Overrides& settings,
                   const Call& call) {
    const commands::DiagnoseCommandOptions options{.model = {},
                                                   .set = {},
                                                   .output = output,
                                                   .without = without,
                                                   .body = body,
                                                   .overrides = overrides_of(settings, call)};
    const auto found = at_work(call, [&] {
        if (!output.empty()) commands::refuse_to_overwrite(output, call.common.force);
        auto diagnosed = commands::diagnose(commands::put_together(model, set.set, set.set.name), options, call.common);
        if (!output.empty()) mesh::write_text(output / "diagnosis.json", diagnosed.json.dump(2) + "\n");
        return diagnosed;
    });
    return py::make_tuple(pipeline::diagnosis_in_words(found.json), as_python(found.json), found.notes);
}

py::tuple improve(const skeleton::Model& model, const TabledSet& set, const fs::path& output,
                  const std::vector<std::string>& add, bool automatic, bool residual, const std::string& body,
                  const Overrides& settings, const Call& call) {
    const commands::ImproveCommandOptions options{.model = {},
                                                  .set = {},
                                                  .output = output,
                                                  .add = add,
                                                  .automatic = automatic,
                                                  .residual = residual,
                                                  .body = body,
                                                  .overrides = overrides_of(settings, call)};
    auto improved = at_work(call, [&] {
        if (!output.empty()) commands::refuse_to_overwrite(output, call.common.force);
        auto found = commands::improve(commands::put_together(model, set.set, set.set.name), options, call.common);
        if (!output.empty()) pipeline::write_ladder(output, found.ladder, *found.body);
        return found;
    });
    const nlohmann::json ladder = pipeline::to_json(improved.ladder);
    auto identified = std::make_shared<identify::IdentifyResult>(std::move(improved.ladder.identified));
    auto last = std::make_shared<skeleton::Model>(std::move(improved.ladder.steps.back().model));
    return py::make_tuple(pipeline::ladder_in_words(ladder), as_python(ladder), last, identified,
                          improved.ladder.notes);
}

/// Forecasts of the skin: displacement (states x vertices x 3) [mm], sd of a coordinate or None (states x vertices),
/// the largest displacement of each state and where it lies with 95 % (states x 3) [mm].
py::tuple forecast(const skeleton::Model& model, const std::vector<identify::LoadState>& states,
                   const fs::path& posterior, int draws, const Call& call) {
    const auto forecasts = at_work(call, [&] {
        const auto uncertainty = posterior.empty() ? std::nullopt : pipeline::read_uncertainty(model, posterior, draws);
        auto found = pipeline::forecast(model, states, uncertainty, call.common.threads);
        if (uncertainty) {
            const Vec3 sizes =
                model.surface.vertices.colwise().maxCoeff() - model.surface.vertices.colwise().minCoeff();
            Console::notices(pipeline::extrapolations(uncertainty->measured, states, found, sizes.maxCoeff()));
        }
        return found;
    });
    const auto n = std::ssize(forecasts), vertices = static_cast<py::ssize_t>(model.surface.vertices.rows());
    std::vector<double> displacement, sd, largest;
    for (const pipeline::Forecast& one : forecasts) {
        displacement.insert(displacement.end(), one.displacement.data(),
                            one.displacement.data() + one.displacement.size());
        sd.insert(sd.end(), one.sd.data(), one.sd.data() + one.sd.size());
        largest.insert(largest.end(), {one.largest, one.low, one.high});
    }
    const py::object spread = sd.empty() ? py::object(py::none()) : py::object(owned(std::move(sd), {n, vertices}));
    return py::make_tuple(owned(std::move(displacement), {n, vertices, 3}), spread, owned(std::move(largest), {n, 3}));
}

/// Where points hang on a surface: corners of the nearest triangle and their shares (n x 3 each).
py::tuple nearest_on(const mesh::Surface& surface, const py::object& given) {
    const Points points = points_of(given, "markers");
    const mesh::SurfaceTree tree(surface);
    Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor> corners(points.rows(), 3);
    Points shares(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const mesh::SurfacePoint near = tree.closest(points.row(i).transpose());
        corners.row(i) = surface.triangles.row(near.triangle);
        shares.row(i) = near.barycentric.transpose();
    }
    const auto copy = [&](const auto& m) {
        using Scalar = typename std::decay_t<decltype(m)>::Scalar;
        return py::array_t<Scalar>({m.rows(), m.cols()}, m.data());
    };
    return py::make_tuple(copy(corners), copy(shares));
}

}  // namespace

void bind_commands_on_objects(py::module_& module) {
    module.def("mesh", [](const fs::path& input, const Overrides& settings, const Call& call) {
        auto built = at_work(call, [&] { return commands::build_body(input, overrides_of(settings, call)); });
        return std::make_shared<mesh::VolumeMesh>(std::move(built.body.volume));
    });
    module.def("skeleton", &skeleton_of);
    module.def("identify",
               [](const skeleton::Model& model, const TabledSet& set, const Overrides& settings, const Call& call) {
                   return std::make_shared<identify::IdentifyResult>(at_work(call, [&] {
                       return commands::identify(commands::put_together(model, set.set, set.set.name),
                                                 overrides_of(settings, call), call.common);
                   }));
               });
    module.def("compare", &compare);
    module.def("diagnose", &diagnose);
    module.def("improve", &improve);
    module.def("forecast",
               [](const skeleton::Model& model, const fs::path& probes, const fs::path& posterior, int draws,
                  const Call& call) { return forecast(model, identify::read_probes(probes), posterior, draws, call); });
    module.def("forecast_set",
               [](const skeleton::Model& model, const TabledSet& set, const fs::path& posterior, int draws,
                  const Call& call) { return forecast(model, set.set.states, posterior, draws, call); });
    module.def("nearest_on", &nearest_on);
}

}  // namespace palpate::python
