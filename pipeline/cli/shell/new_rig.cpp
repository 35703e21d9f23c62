#include "pipeline/cli/shell/new_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "mesh/topology/shells.h"
#include "pipeline/cli/shell/templates.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// A box with another one, hollow, in it.
mesh::Surface hollow_finger() {
    return mesh::with_cavity(mesh::make_box({0, 0, 0}, {80, 16, 16}, {20, 4, 4}),
                             mesh::make_box({8, 3, 9}, {74, 13, 13}, {16, 3, 2}));
}

struct Rig {
    std::string name;
    std::string_view files;  // ">>> NAME" and the text of each
    std::function<mesh::Surface()> body;
};

const std::vector<Rig>& rigs() {
    static const std::vector<Rig> all{{"indenter", rig_indenter_text,
                                       [] {
                                           return mesh::make_box({0, 0, 0}, {60, 60, 30}, {12, 12, 6});
                                       }},
                                      {"tensile", rig_tensile_text,
                                       [] {
                                           return mesh::make_box({0, 0, 0}, {60, 10, 4}, {24, 4, 2});
                                       }},
                                      {"pneumatic", rig_pneumatic_text, hollow_finger},
                                      {"tendon", rig_tendon_text, [] {
                                           return mesh::make_box({0, 0, 0}, {100, 12, 12}, {25, 3, 3});
                                       }}};
    return all;
}

/// What an empty set stands beside until there is a body.
mesh::Surface example_bar() { return mesh::make_box({0, 0, 0}, {100, 20, 20}, {20, 4, 4}); }

void write_files(const fs::path& folder, std::string_view files) {
    constexpr std::string_view mark = ">>> ";
    while (files.starts_with(mark)) {
        const std::size_t line = files.find('\n'), next = std::min(files.find("\n>>> ", line), files.size() - 1);
        const std::string name(files.substr(mark.size(), line - mark.size()));
        mesh::write_text(folder / name, std::string(files.substr(line + 1, next - line)));
        files.remove_prefix(next + 1);
    }
}

}  // namespace

const std::vector<std::string>& rig_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        std::ranges::transform(rigs(), std::back_inserter(all), &Rig::name);
        return all;
    }();
    return names;
}

Outcome new_measurements(const NewOptions& options) {
    write_files(options.folder, rig_measurements_text);
    mesh::write_surface(options.folder / "body.stl", example_bar());
    const std::string folder = options.folder.string();
    return {
        .text =
            fmt::format("{0}: an empty measurement set, its files explained, and body.stl, a bar in the place of "
                        "your body; probes.csv, markers.csv and positions.csv are its tables.\nNext: fill in the three "
                        "tables, then palpate check {0}\n",
                        folder),
        .json = {{"set", (options.folder / "set.yaml").string()}, {"mesh", (options.folder / "body.stl").string()}}};
}

Outcome new_rig(const NewOptions& options) {
    const Rig& rig = *std::ranges::find(rigs(), options.rig, &Rig::name);
    write_files(options.folder, rig.files);
    mesh::write_surface(options.folder / "body.stl", rig.body());
    const std::string folder = options.folder.string();
    return {.text = fmt::format("{0}: a measurement set as a rig of the kind '{1}' writes it, its files explained, and "
                                "body.stl, a small body: put your own numbers and surface in their place.\nNext: "
                                "palpate check {0}\n",
                                folder, rig.name),
            .json = {{"set", (options.folder / "set.yaml").string()},
                     {"mesh", (options.folder / "body.stl").string()},
                     {"rig", rig.name}}};
}

}  // namespace palpate::pipeline::commands
