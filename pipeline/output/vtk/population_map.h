#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// A kind of stiffness over the links of a mean specimen.
struct LinkMap {
    std::string kind, unit;  // "flexion", "N*mm/rad"
    Eigen::VectorXd mean;    // of the population (links); NaN where less than two specimens tell it
    Eigen::VectorXd spread;  // one standard deviation of its logarithm (links) [-]; NaN likewise
    Eigen::Index known() const { return (mean.array() == mean.array()).count(); }
};

/// Of population.json, what is told of single links, the kind that is known of most links first.
std::vector<LinkMap> maps_of_links(const nlohmann::json& population, std::size_t links);

/// mean_skeleton.vtp, links with mean and spread of each kind, and mean_body.vtp, the surface with the mean of the
/// links that carry each vertex (geometric of the means).
void write_population_maps(const std::filesystem::path& folder, const skeleton::Model& mean,
                           const std::vector<LinkMap>& maps);

}  // namespace palpate::pipeline
