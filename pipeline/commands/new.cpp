#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "mesh/read_surface.h"
#include "pipeline/commands/common.h"
#include "pipeline/shell/templates.h"

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

}  // namespace

Outcome new_case(const NewOptions& options, const Common&) {
    const fs::path folder = options.folder;
    if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder))) {
        throw InvalidInput(fmt::format("{}: exists already; choose another name", folder.string()));
    }
    mesh::write_text(folder / "case.yaml", std::string(new_case_text));
    mesh::write_surface(folder / "body.stl", example_body());
    const std::string file = (folder / "case.yaml").string();
    return {.text = fmt::format("{}: a case with every setting explained, and body.stl, a small bar to try it on: put "
                                "your own mesh in its place.\nNext: palpate run {}\n",
                                folder.string(), file),
            .json = {{"case", file}, {"mesh", (folder / "body.stl").string()}}};
}

}  // namespace palpate::pipeline::commands
