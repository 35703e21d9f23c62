#include "pipeline/command_line/version_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/libraries.h"
#include "pipeline/version.h"

namespace palpate::pipeline {
namespace {

nlohmann::json version_json() {
    nlohmann::json libraries = nlohmann::json::array();
    for (const LinkedLibrary& library : linked_libraries) {
        libraries.push_back({{"name", library.name},
                             {"version", library.version},
                             {"licence", library.licence},
                             {"purpose", library.purpose}});
    }
    return {{"version", version},
            {"licence", own_licence},
            {"licence_of_the_program", binary_licence},
            {"formats", {"palpate-model/1", "palpate-measurements/1", "palpate-measurements/2", "palpate-case/1"}},
            {"libraries", libraries}};
}

}  // namespace

std::string version_text(bool json) {
    if (json) return version_json().dump(2);
    std::string text = fmt::format(
        "palpate {}\n\nOur own code is under the {} licence. The program as a whole is under\n{}, for it is linked "
        "with\n",
        version, own_licence, binary_licence);
    for (const LinkedLibrary& library : linked_libraries) {
        text += fmt::format("  {:<14} {:<9} {}\n", library.name, library.version, library.licence);
    }
    return text + "There is no warranty. libpalpate_runtime.so holds none of CGAL, TetGen and CHOLMOD.";
}

}  // namespace palpate::pipeline
