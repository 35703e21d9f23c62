#include "pipeline/synthesis/probing/skeleton_probing.h"

#include <random>

#include "mesh/errors.h"
#include "mesh/geometry/sampling.h"

namespace palpate::pipeline {
namespace {

std::vector<int> free_spheres(const skeleton::Model& model) {
    std::vector<int> free;
    for (int s = 0; s < static_cast<int>(model.spheres.size()); ++s) {
        if (!model.spheres[s].held) free.push_back(s);
    }
    if (free.empty()) throw InvalidInput("every sphere of the model is held; none is left to be probed");
    return free;
}

Points centers_of(const skeleton::Model& model, const std::vector<int>& spheres) {
    Points centers(static_cast<Eigen::Index>(spheres.size()), 3);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        centers.row(static_cast<Eigen::Index>(i)) = model.spheres[spheres[i]].center;
    }
    return centers;
}

Vec3 random_direction(std::mt19937_64& random) {
    std::normal_distribution<double> gauss;
    return Vec3(gauss(random), gauss(random), gauss(random)).normalized();
}

}  // namespace

std::vector<mesh::Contact> twin_contacts(const skeleton::Model& model, const ProbeOptions& options,
                                         std::uint64_t seed) {
    options.validate();
    std::mt19937_64 random(seed);
    const std::vector<int> free = free_spheres(model);
    const auto first = std::uniform_int_distribution<int>(0, static_cast<int>(free.size()) - 1)(random);
    const std::vector<int> order = mesh::farthest_points(centers_of(model, free), static_cast<int>(free.size()), first);
    std::vector<mesh::Contact> contacts;
    contacts.reserve(static_cast<std::size_t>(options.probes));
    for (int p = 0; p < options.probes; ++p) {
        const int site = free[order[static_cast<std::size_t>(p) % order.size()]];
        contacts.push_back({model.spheres[site].center, random_direction(random), 0.0});
    }
    return contacts;
}

}  // namespace palpate::pipeline
