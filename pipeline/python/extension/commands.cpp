#include "pipeline/command_line/commands.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "fem/large_deformation/material_law_names.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/border.h"
#include "pipeline/python/extension/conversions/overrides.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
namespace commands = pipeline::commands;

/// (text, result, exit code) of a command, as the program has it.
py::tuple told(const commands::Outcome& outcome) {
    return py::make_tuple(outcome.text, as_python(outcome.json), static_cast<int>(outcome.code));
}

py::list all_settings() {
    py::list list;
    for (const auto& setting : pipeline::settings()) {
        list.append(py::dict(py::arg("place") = setting.place(), py::arg("flag") = setting.flag,
                             py::arg("group") = setting.group, py::arg("help") = setting.help));
    }
    return list;
}

pipeline::BlindSetOptions synthesis_of(const py::dict& given) {
    pipeline::BlindSetOptions how;
    for (const auto& [key, value] : given) {
        const auto name = key.cast<std::string>();
        if (value.is_none()) continue;
        if (name == "hide") how.hide = value.cast<std::vector<std::string>>();
        if (name == "levels") how.levels = value.cast<int>();
        if (name == "dwell") how.dwell = value.cast<std::vector<double>>();
        if (name == "unload") how.unload = value.cast<bool>();
        if (name == "back") how.back = value.cast<bool>();
        if (name == "continuous") how.continuous = value.cast<bool>();
        if (name == "missing") how.missing = value.cast<double>();
        if (name == "unlabelled") how.unlabelled = value.cast<double>();
        if (name == "include_material") how.include_material = value.cast<bool>();
        if (name != "law") continue;
        how.law = fem::material_law(value.cast<std::string>());
        if (!how.law)
            throw InvalidInput("law: is '" + value.cast<std::string>() + "', must be linear, svk or neo-hooke");
    }
    how.validate();
    return how;
}

}  // namespace

void bind_commands(py::module_& module) {
    module.def("settings", &all_settings);
    module.def("objection", [](const std::string& place, const std::string& value) {
        return pipeline::objection_to_value(place, value);
    });
    module.def("run", [](const fs::path& input, const fs::path& output, const Overrides& settings, const Call& call) {
        const commands::RunOptions options{input, output, overrides_of(settings, call)};
        return told(at_work(call, [&] { return commands::run(options, call.common); }));
    });
    module.def("check", [](const fs::path& input, const fs::path& output, const std::vector<std::string>& expect,
                           bool cost, const Overrides& settings, const Call& call) {
        const commands::CheckOptions options{input, output, expect, cost, overrides_of(settings, call)};
        return told(at_work(call, [&] { return commands::check(options, call.common); }));
    });
    module.def("probe", [](const fs::path& input, const fs::path& output, const Overrides& settings,
                           const py::dict& synthesis, const Call& call) {
        const commands::ProbeCommandOptions options{.input = input,
                                                    .output = output,
                                                    .overrides = overrides_of(settings, call),
                                                    .synthesis = synthesis_of(synthesis)};
        return told(at_work(call, [&] { return commands::probe(options, call.common); }));
    });
    module.def("simulate_motion", [](const fs::path& model, const fs::path& probes, const fs::path& output, double dt,
                                     double duration, std::optional<double> damping, bool implicit, const Call& call) {
        const commands::SimulateOptions options{.model = model,
                                                .probes = probes,
                                                .output = output,
                                                .dt = dt,
                                                .duration = duration,
                                                .damping = damping,
                                                .implicit = implicit};
        return told(at_work(call, [&] { return commands::simulate(options, call.common); }));
    });
    module.def("export_model",
               [](const fs::path& model, const fs::path& output, const std::string& to, const Call& call) {
                   const commands::ExportOptions options{.model = model, .output = output, .to = to, .probes = {}};
                   return told(at_work(call, [&] { return commands::export_model(options, call.common); }));
               });
    module.def("play_page", [](const fs::path& model, const fs::path& output, const Call& call) {
        const commands::PlayOptions options{.input = model, .output = output};
        return told(at_work(call, [&] { return commands::play(options, call.common); }));
    });
    module.def("diagnosis_in_words",
               [](const std::string& json) { return pipeline::diagnosis_in_words(nlohmann::json::parse(json)); });
    module.def("ladder_in_words",
               [](const std::string& json) { return pipeline::ladder_in_words(nlohmann::json::parse(json)); });
    module.def("effects",
               [](const std::string& name, const Call& call) { return told(commands::effects({name}, call.common)); });
}

}  // namespace palpate::python
