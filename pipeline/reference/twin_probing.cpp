#include "pipeline/reference/twin_probing.h"

#include <numeric>
#include <random>

#include "identify/set/twin.h"
#include "mesh/errors.h"
#include "mesh/sampling.h"
#include "skeleton/statics.h"

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

identify::MeasurementSet probe_twin(const skeleton::Model& model, const ProbeOptions& options, std::uint64_t seed) {
    options.validate();
    std::mt19937_64 random(seed);
    const std::vector<int> free = free_spheres(model);
    const Points centers = centers_of(model, free);
    const auto first = std::uniform_int_distribution<int>(0, static_cast<int>(free.size()) - 1)(random);
    const std::vector<int> order = mesh::farthest_points(centers, static_cast<int>(free.size()), first);

    std::vector<int> everything(model.spheres.size());
    std::iota(everything.begin(), everything.end(), 0);
    const double longest = mesh::bounding_box(centers_of(model, everything)).longest_side();
    skeleton::StaticsSolver solver(model);
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);

    std::vector<identify::LoadState> states(1);
    for (int p = 0; p < options.probes; ++p) {
        const int site = free[order[static_cast<std::size_t>(p) % order.size()]];
        const Vec3 direction = random_direction(random);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(model.dofs());
        force.segment<3>(6 * site) = direction;
        const double compliance = solver.linear_steps(k, force).col(0).segment<3>(6 * site).norm();  // [mm/N]
        identify::LoadState& state = states.emplace_back();
        state.probe = p + 1;
        state.contacts = {{model.spheres[site].center, direction * (options.displacement * longest / compliance), 0.0}};
    }
    return identify::simulate_measurements(model, std::move(states), identify::markers_on_spheres(model), options.noise,
                                           seed);
}

}  // namespace palpate::pipeline
