#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/cli/shell/new_rig.h"
#include "pipeline/cli/shell/templates.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// A bar with a bump on it, so that there is something to look at.
mesh::Surface example_body() {
    mesh::Surface bar = mesh::make_box({0, 0, 0}, {80, 16, 12}, {20, 4, 3});
    for (auto p : bar.vertices.rowwise()) {
        if (p.z() > 11.9) p.z() += 6 * std::exp(-(std::pow(p.x() - 55, 2) + std::pow(p.y() - 8, 2)) / 120);
    }
    return bar;
}

/// The template, its placeholders replaced by the settings.
std::string commented_case() {
    const std::vector<Example> examples{
        {"unit", "mm"},           {"material.young", "0.1"}, {"material.poisson", "0.45"}, {"material.density", "1000"},
        {"probing.probes", "24"}, {"probing.held_out", "4"}};
    std::string text(new_case_text);
    const auto fill_in = [&](const std::string& name, const std::string& lines) {
        const std::string placeholder = "{" + name + "}";
        text.replace(text.find(placeholder), placeholder.size(), lines);
    };
    for (const char* section : {"material", "volume", "skeleton", "probing", "identify", "diagnose", "expect"})
        fill_in(section, example_section_yaml(section, examples));
    for (const char* place : {"unit", "longest", "label", "keep", "seed"})
        fill_in(place, example_yaml(setting_at(place), examples));
    fill_in("surface_formats", mesh::surface_extensions());
    return text;
}

}  // namespace

Outcome new_case(const NewOptions& options, const Common&) {
    const fs::path folder = options.folder;
    if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder))) {
        throw InvalidInput(fmt::format("{}: exists already; choose another name", folder.string()));
    }
    if (options.measurements) return new_measurements(options);
    if (!options.rig.empty()) return new_rig(options);
    mesh::write_text(folder / "case.yaml", commented_case());
    mesh::write_surface(folder / "body.stl", example_body());
    const std::string file = (folder / "case.yaml").string();
    return {.text = fmt::format("{}: a case with every setting explained, and body.stl, a small bar to try it on: put "
                                "your own mesh in its place.\nNext: palpate run {}\n",
                                folder.string(), file),
            .json = {{"case", file}, {"mesh", (folder / "body.stl").string()}}};
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_new(CLI::App& app) {
    auto* sub = subcommand(app, "new", "A commented case, or measurement set, to start from.",
                           "  palpate new my-body && palpate run my-body/case.yaml\n"
                           "  palpate new --measurements my-set              # empty tables, to fill in\n"
                           "  palpate new --rig indenter my-set && palpate check my-set\n",
                           [this] { return commands::new_case(new_case, common); });
    sub->add_option("NAME", new_case.folder, "The folder to make")->required();
    auto* measurements = sub->add_flag("--measurements", new_case.measurements,
                                       "An empty measurement set to fill in, in place of a case");
    sub->add_option("--rig", new_case.rig, "A measurement set, as such a rig writes it, in place of a case")
        ->excludes(measurements)
        ->check(CLI::IsMember(commands::rig_names()));
}

}  // namespace palpate::pipeline
