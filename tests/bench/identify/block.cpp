#include "block.h"

#include <cmath>

#include "identify/loading/twin.h"
#include "identify/numerics/random.h"
#include "samples/lattice.h"

namespace palpate::bench {

using namespace identify;

Block::Block(int n, skeleton::EquilibriumLaw law) {
    constexpr double noise = 0.01;
    start = samples::make_lattice("block", {n, n, n}, 1);
    start.law = law;
    truth = start;
    for (skeleton::Link& link : truth.links) {
        const Vec3 at = (truth.spheres[link.a].center + truth.spheres[link.b].center) / (2 * 40.0 * n);
        link.stiffness[0] *= std::exp(0.5 * std::sin(7 * at.x()) * std::cos(5 * at.y()));
        link.stiffness[1] *= std::exp(0.5 * std::cos(6 * at.x() + 3 * at.z()));
    }
    std::vector<Marker> markers;
    const auto on_surface = [&](const Vec3& c) {
        return (c.array() == 0).any() || (c.array() == 40.0 * (n - 1)).any();
    };
    for (const Marker& marker : markers_on_spheres(start)) {
        if (on_surface(*marker.anchor)) markers.push_back(marker);
    }
    std::vector<LoadState> states;
    for (int p = 0; p < 12; ++p) {
        RandomStream random(3, 0, p);
        Vec3 at = 40.0 * (Vec3(random.uniform(), random.uniform(), random.uniform()) * (n - 1)).array().round();
        at[p % 3] = 40.0 * (n - 1);
        const Vec3 force = 2.0 * random.normals(3).normalized();
        states.push_back({.probe = p + 1, .contacts = {{at, force, 0}}});
    }
    set = simulate_measurements(truth, states, markers, noise, 1);
}

}  // namespace palpate::bench
