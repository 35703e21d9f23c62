#include "mesh/formats/solution/read_solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution_parts.h"

namespace palpate::mesh {
namespace {

std::string extension_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

}  // namespace

bool is_solution_file(const std::filesystem::path& file) {
    const std::string extension = extension_of(file);
    return extension == ".frd" || extension == ".dat" || extension == ".vtu" || extension == ".vtp";
}

Solution read_solution(const std::filesystem::path& file, const Deck* deck, const std::string& array) {
    const std::string extension = extension_of(file);
    Solution solution = extension == ".frd"   ? read_frd(file)
                        : extension == ".dat" ? read_dat(file, deck)
                                              : read_vtk_solution(file, array);
    if (solution.steps.empty())
        throw InvalidInput(
            fmt::format("{}: holds no displacements. Let the solver write them (CalculiX: *NODE FILE or "
                        "*NODE PRINT, and U behind it).",
                        file.string()));
    return solution;
}

}  // namespace palpate::mesh
