#include "mesh/formats/volume/labelled_parts.h"

#include <fmt/format.h>

#include <map>
#include <string>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

Surface surface_of_elements(const VolumeMesh& mesh, const std::vector<Eigen::Index>& elements) {
    VolumeMesh part{mesh.nodes, mesh.tetrahedra(elements, Eigen::all), {}};
    part.faces = boundary_faces(part.tetrahedra);
    return boundary_surface(part);
}

std::string list_of(const std::map<std::int64_t, std::vector<Eigen::Index>>& elements_of) {
    constexpr std::size_t enough = 100;  // characters
    std::string list;
    for (const auto& [label, elements] : elements_of) {
        if (list.size() > enough) return list + ", ...";
        list += fmt::format("{}{} ({} elements)", list.empty() ? "" : ", ", label, elements.size());
    }
    return list;
}

}  // namespace

std::vector<Surface> labelled_parts(const VolumeMesh& mesh, const std::vector<std::int64_t>& labels,
                                    const std::vector<int>& asked, const std::filesystem::path& file) {
    std::vector<Surface> parts;
    if (asked.empty()) return parts;
    if (labels.empty())
        throw InvalidInput(
            fmt::format("{}: tells no materials of its elements, so that label {} means nothing there. Give the mesh "
                        "with a cell array of whole numbers named 'material', 'region' or 'label' (of .vtu; a physical "
                        "group of .msh), or the region's surface by 'surface'.",
                        file.string(), asked.front()));
    std::map<std::int64_t, std::vector<Eigen::Index>> elements_of;
    for (std::size_t e = 0; e < labels.size(); ++e) elements_of[labels[e]].push_back(static_cast<Eigen::Index>(e));
    parts.reserve(asked.size());
    for (const int label : asked) {
        const auto found = elements_of.find(label);
        if (found == elements_of.end())
            throw InvalidInput(fmt::format("{}: no element has the label {}; there are {}.", file.string(), label,
                                           list_of(elements_of)));
        parts.push_back(surface_of_elements(mesh, found->second));
    }
    return parts;
}

}  // namespace palpate::mesh
