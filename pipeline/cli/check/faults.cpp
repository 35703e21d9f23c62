#include "pipeline/cli/check/faults.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::pipeline::commands {

std::string describe_places(const std::vector<mesh::FaultPlace>& places) {
    constexpr std::ptrdiff_t most_listed = 3;
    std::string text;
    for (auto first = places.begin(); first != places.end();) {
        const auto end = std::find_if(first, places.end(), [&](auto& place) { return place.fault != first->fault; });
        text += fmt::format("    {}: at ", mesh::name_of(first->fault));
        for (auto place = first; place != std::min(first + most_listed, end); ++place) {
            text += fmt::format("{}({:.4g}, {:.4g}, {:.4g})", place == first ? "" : ", ", place->at.x(), place->at.y(),
                                place->at.z());
        }
        if (end - first > most_listed) text += fmt::format(" and {} more", end - first - most_listed);
        text += " mm\n";
        first = end;
    }
    return text;
}

nlohmann::json places_json(const std::vector<mesh::FaultPlace>& places) {
    constexpr std::size_t most = 1000;  // the rest stands in faults.vtp
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < std::min(places.size(), most); ++i) {
        const mesh::FaultPlace& place = places[i];
        list.push_back({{"fault", mesh::name_of(place.fault)},
                        {"at", {place.at.x(), place.at.y(), place.at.z()}},
                        {"triangles", place.triangles}});
    }
    return list;
}

void write_faults(const std::filesystem::path& folder, const mesh::Surface& surface,
                  const std::vector<mesh::FaultPlace>& places) {
    Eigen::MatrixXd of_triangle = Eigen::MatrixXd::Zero(surface.triangles.rows(), 1);
    Eigen::MatrixXd of_point(std::ssize(places), 1);
    Points points(std::ssize(places), 3);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto code = static_cast<double>(places[i].fault);
        for (const int t : places[i].triangles) of_triangle(t, 0) = code;
        of_point(static_cast<Eigen::Index>(i), 0) = code;
        points.row(static_cast<Eigen::Index>(i)) = places[i].at;
    }
    mesh::write_vtp(folder / "surface.vtp", surface, {.points = {}, .cells = {{"fault", of_triangle}}});
    mesh::write_vtp_lines(folder / "faults.vtp", points, {}, {.points = {{"fault", of_point}}, .cells = {}});
}

}  // namespace palpate::pipeline::commands
