#include "pipeline/output/vtk/population_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/words.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A link's value, averaged over the links of each sphere, then over the spheres that carry each vertex (vertices).
Eigen::VectorXd on_skin(const skeleton::Model& model, const Eigen::VectorXd& of_links) {
    const auto spheres = static_cast<Eigen::Index>(model.spheres.size());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(spheres), count = sum;
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const double value = of_links[static_cast<Eigen::Index>(l)];
        if (std::isnan(value)) continue;
        for (const int sphere : {model.links[l].a, model.links[l].b}) {
            sum[sphere] += value;
            count[sphere] += 1;
        }
    }
    Eigen::VectorXd result(static_cast<Eigen::Index>(model.skin.size()));
    for (Eigen::Index v = 0; v < result.size(); ++v) {
        double value = 0, weight = 0;
        for (const skeleton::SphereInfluence& share : model.skin[static_cast<std::size_t>(v)].shares) {
            if (count[share.sphere] == 0) continue;
            value += share.weight * sum[share.sphere] / count[share.sphere];
            weight += share.weight;
        }
        result[v] = weight > 0 ? value / weight : unknown;
    }
    return result;
}

}  // namespace

std::vector<LinkMap> maps_of_links(const json& population, std::size_t links) {
    std::vector<LinkMap> maps;
    for (const json& number : population["numbers"]) {
        const auto name = number["name"].get<std::string>();
        const auto at = name.find(":link");
        if (at == std::string::npos) continue;
        const std::string kind = name.substr(0, at);
        const auto link = mesh::parse_integer(std::string_view(name).substr(at + 5));
        if (!link || *link < 0 || static_cast<std::size_t>(*link) >= links) continue;
        auto map = std::ranges::find(maps, kind, &LinkMap::kind);
        if (map == maps.end()) {
            const auto none = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(links), unknown);
            maps.push_back({kind, number["unit"], none, none});
            map = maps.end() - 1;
        }
        map->mean[*link] = number["mean"]["value"];
        map->spread[*link] = number["spread"]["value"];
    }
    std::ranges::stable_sort(maps, std::greater{}, &LinkMap::known);
    return maps;
}

void write_population_maps(const std::filesystem::path& folder, const skeleton::Model& mean,
                           const std::vector<LinkMap>& maps) {
    mesh::MeshData of_links, of_skin;
    for (const LinkMap& map : maps) {
        const std::string name_of_mean = fmt::format("mean {} [{}]", map.kind, map.unit),
                          name_of_spread = fmt::format("spread of ln {} [-]", map.kind);
        of_links.cells.push_back({name_of_mean, map.mean});
        of_links.cells.push_back({name_of_spread, map.spread});
        of_skin.points.push_back({name_of_mean, on_skin(mean, map.mean.array().log()).array().exp()});
        of_skin.points.push_back({name_of_spread, on_skin(mean, map.spread)});
    }
    skeleton::write_model_vtp(folder / "mean_skeleton.vtp", mean, of_links);
    mesh::write_vtp(folder / "mean_body.vtp", mean.surface, of_skin);
}

}  // namespace palpate::pipeline
