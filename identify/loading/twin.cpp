#include "identify/loading/twin.h"

#include "identify/loading/loads.h"
#include "identify/loading/readings.h"
#include "identify/numerics/random.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

MeasurementSet simulate_measurements(const skeleton::Model& model, std::vector<LoadState> states,
                                     std::vector<Marker> markers, double noise, std::uint64_t seed) {
    MeasurementSet set;
    set.name = model.name;
    set.rest_surface = model.surface;
    set.supports = model.supports;
    if (noise > 0) set.position_noise = noise;
    set.markers = std::move(markers);
    set.states = std::move(states);

    const std::vector<skeleton::Attachment> points = marker_attachments(model, set.markers);
    const ContactLoads loads(model);
    skeleton::StaticsSolver solver(model);
    const Eigen::VectorXd k = stiffness_vector(model);
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        LoadState& state = set.states[s];
        const skeleton::Load load = loads(set, state);
        const Points positions = observed(model, solver.solve(k, load), load, points);
        RandomStream random(seed, s, 0);
        state.readings.clear();
        for (int i = 0; i < static_cast<int>(points.size()); ++i) {
            state.readings.push_back({i, positions.row(i).transpose() + noise * Vec3(random.normals(3)), missing});
        }
    }
    return set;
}

std::vector<Marker> markers_on_spheres(const skeleton::Model& model) {
    constexpr int per_sphere = 4;
    const Vec3 corners[per_sphere] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    std::vector<Marker> markers;
    for (const skeleton::Sphere& sphere : model.spheres) {
        if (sphere.held) continue;
        for (const Vec3& corner : corners) {
            markers.push_back(
                {static_cast<int>(markers.size()), sphere.center + sphere.radius / 2 * corner, sphere.center});
        }
    }
    return markers;
}

}  // namespace palpate::identify
