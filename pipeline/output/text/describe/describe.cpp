#include "pipeline/output/text/describe/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/output/text/describe/describe_rig.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

std::string known_kinds() {
    return fmt::format(
        "a run folder, a measurement set, a case.yaml, our JSON and CSV files, .pvd, .vtu, a body ({}, .msh, .mesh, "
        ".node, .ele, .inp, CAD, labels), or results of CalculiX (.frd)",
        mesh::surface_extensions());
}

Description describe_folder(const fs::path& folder) {
    if (fs::exists(folder / "run.json")) return describe_run(folder);
    if (fs::exists(folder / "set.yaml")) return describe_set(folder);
    if (fs::exists(folder / "case.yaml")) return describe_case(folder / "case.yaml");
    for (const char* result : {"ladder.json", "diagnosis.json", "compare.json", "model.json"}) {
        if (fs::exists(folder / result)) {
            Description description = describe_json(folder / result);
            description.lines.insert(description.lines.begin(),
                                     fmt::format("It holds {}, {}", result, description.kind));
            description.kind = "a folder of results";
            return description;
        }
    }
    throw InvalidInput(
        fmt::format("{}: the folder holds nothing that is known; known are {}", folder.string(), known_kinds()));
}

std::string extension_of(const fs::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

Description describe_yaml(const fs::path& file) {
    const std::string format = mesh::YamlFields::from_file(file).text("format");
    return format.starts_with("palpate-measurements") ? describe_set(file) : describe_case(file);
}

}  // namespace

Description describe(const fs::path& file) {
    if (!fs::exists(file)) throw IoError(fmt::format("{}: no such file or folder.", file.string()));
    if (fs::is_directory(file)) return describe_folder(file);
    const std::string extension = extension_of(file);
    if (extension == ".yaml" || extension == ".yml") return describe_yaml(file);
    if (extension == ".json") return describe_json(file);
    if (extension == ".csv") return describe_table(file);
    if (extension == ".pvd") return describe_series(file);
    if (extension == ".vtp") return describe_poly_data(file);
    if (extension == ".vtu") return describe_volume(file);
    if (mesh::surface_format_of(file)) return describe_surface(file);
    if (extension == ".frd") return describe_solution(file);
    if (mesh::is_body_file(file)) return describe_body(file);
    throw InvalidInput(fmt::format("{}: not a kind of file that is known; known are {}", file.string(), known_kinds()));
}

Description describe_set(const fs::path& path) {
    std::vector<std::string> notes;
    const identify::MeasurementSet set = read_measurements(path, notes);
    std::size_t readings = 0;
    for (const auto& state : set.states) readings += state.readings.size();
    Description description{.kind = "a measurement set, '" + set.name + "'", .lines = {}, .next = {}};
    description.lines.push_back(fmt::format("{} states, {} of them loaded; {} markers, {} readings", set.states.size(),
                                            loaded_states(set), set.markers.size(), readings));
    std::ranges::move(rig_in_words(set), std::back_inserter(description.lines));
    for (const identify::MotionRecording& recording : set.recordings) {
        description.lines.push_back(fmt::format("probe {} in motion: {} instants, to {:g} s", recording.probe,
                                                recording.instants.size(), recording.instants.back().time));
    }
    description.lines.push_back(fmt::format("held by {} region{}; surface of {} vertices", set.supports.size(),
                                            set.supports.size() == 1 ? "" : "s", set.rest_surface.vertices.rows()));
    if (set.position_noise)
        description.lines.push_back(fmt::format("noise {:.3g} mm (1 sigma)", *set.position_noise));
    else if (readings > 0 || set.reaction_noise == std::nullopt)
        description.lines.emplace_back("no noise is declared: it is estimated");
    if (set.gravity)
        description.lines.push_back(fmt::format("gravity ({:g}, {:g}, {:g}) mm/s^2 is known to act", set.gravity->x(),
                                                set.gravity->y(), set.gravity->z()));
    std::ranges::copy(notes, std::back_inserter(description.lines));
    const bool is_fittable = identify::parts_not_fitted_yet(set).empty();
    description.next = (is_fittable ? "palpate run " : "palpate check ") + path.string();
    return description;
}

Description describe_case(const fs::path& file) {
    const Case c = read_case(file);
    Description description{.kind = "a case, '" + c.name + "'", .lines = {}, .next = "palpate run " + file.string()};
    description.lines.push_back(c.mesh ? "about the mesh " + c.mesh->string()
                                       : "about the measurements " + c.measurements->string());
    if (c.young) description.lines.push_back(fmt::format("E = {:g} MPa", *c.young));
    if (!c.diagnose.without.empty())
        description.lines.push_back("leaves out of the catalogue: " + listed(c.diagnose.without));
    return description;
}

}  // namespace palpate::pipeline
