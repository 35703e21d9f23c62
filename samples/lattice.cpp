#include "samples/lattice.h"

#include <algorithm>

#include "identify/loading/twin.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::samples {
namespace {

constexpr double spacing = 40;  // [mm]

skeleton::Sphere lattice_sphere(const Vec3& center) {
    constexpr double radius = 10, mass = 1e-6;  // [mm], [tonne]
    return {center, radius, mass, 0.4 * mass * radius * radius * Mat3::Identity(), center.x() == 0};
}

/// A state for each force, on one free sphere after the other.
std::vector<identify::LoadState> push_spheres(const skeleton::Model& model, const std::vector<Vec3>& forces) {
    std::vector<int> free;
    for (int s = 0; s < static_cast<int>(model.spheres.size()); ++s) {
        if (!model.spheres[s].held) free.push_back(s);
    }
    std::vector<identify::LoadState> states;
    std::size_t next = free.size() - 1;
    for (const Vec3& force : forces) {
        identify::LoadState& state = states.emplace_back();
        state.probe = static_cast<int>(states.size());
        state.contacts = {{model.spheres[free[next]].center, force, 0}};
        next = (next + 7) % free.size();  // seven spheres on: another corner of the lattice
    }
    return states;
}

Experiment make_experiment(const skeleton::Model& start, const std::vector<double>& kE, const std::vector<double>& kF,
                           const std::vector<Vec3>& forces) {
    skeleton::Model truth = start;
    for (skeleton::Link& link : truth.links) {
        link.stiffness[0] = kE[link.zone];
        link.stiffness[1] = kF[link.zone];
    }
    identify::MeasurementSet set =
        identify::simulate_measurements(truth, push_spheres(truth, forces), identify::markers_on_spheres(truth));
    set.name = start.name;
    return {start, set, kE, kF};
}

}  // namespace

skeleton::Model make_lattice(const std::string& name, const Eigen::Vector3i& n, int zones) {
    skeleton::Model model;
    model.name = name;
    const auto index = [&](int i, int j, int k) { return (i * n.y() + j) * n.z() + k; };
    for (int i = 0; i < n.x(); ++i) {
        const int zone = std::min(zones - 1, i * zones / (n.x() - 1));
        for (int j = 0; j < n.y(); ++j) {
            for (int k = 0; k < n.z(); ++k) {
                model.spheres.push_back(lattice_sphere(spacing * Vec3(i, j, k)));
                const auto join = [&](int other) {
                    model.links.push_back({index(i, j, k), other, spacing, Vec3(2, 750, 500), zone, 0, {}});
                };
                if (i + 1 < n.x()) join(index(i + 1, j, k));
                if (j + 1 < n.y()) join(index(i, j + 1, k));
                if (k + 1 < n.z()) join(index(i, j, k + 1));
            }
        }
    }
    // a sheet's skin lies a little off its spheres, a chain's less
    const Vec3 off = n.y() == 1 ? Vec3(0, 2, 2) : Vec3(0, 0, n.z() == 1 ? 8 : 0);
    const Vec3 low = -off, high = spacing * (n.array() - 1).matrix().cast<double>() + off;
    model.surface = mesh::make_box(low, high, (n.array() - 1).max(1));
    for (Eigen::Index v = 0; v < model.surface.vertices.rows(); ++v) {
        model.skin.push_back(skeleton::attach_to_links(model, model.surface.vertices.row(v).transpose()));
    }
    model.supports = {mesh::BoxRegion{low - Vec3(1, 1, 1), Vec3(1, high.y() + 1, high.z() + 1)}};
    return model;
}

Experiment make_cube_experiment() {
    return make_experiment(make_lattice("burion-cube", {3, 3, 2}, 1), {1.3}, {430},
                           {{0, 0, -6}, {6, 0, 0}, {0, 6, 0}, {0, 0, 6}, {-6, 0, 0}, {4.8, -3.6, 0}});
}

Experiment make_sheet_experiment() {
    return make_experiment(make_lattice("burion-sheet", {6, 3, 1}, 3), {0.9, 2.6, 1.5}, {300, 850, 520},
                           {{0, 0, -0.5}, {10, 0, 0}, {0, 10, 0}, {0, 0, 0.5}, {-10, 0, 0}, {8, -6, 0}});
}

Experiment make_two_strings() {
    skeleton::Model start = make_lattice("two-strings", {3, 1, 1}, 2);
    start.spheres.back().held = true;
    start.supports.emplace_back(mesh::BoxRegion{Vec3(79, -3, -3), Vec3(81, 3, 3)});
    for (skeleton::Link& link : start.links) link.stiffness = Vec3(2, 10, 10);
    skeleton::Model truth = start;
    truth.links[0].stiffness[0] = 1;
    truth.links[1].stiffness[0] = 3;

    std::vector<identify::LoadState> states;
    for (const Vec3& force : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 0.05), Vec3(0, 0, -0.05)}) {
        states.push_back({.probe = static_cast<int>(states.size()) + 1, .contacts = {{Vec3(40, 0, 0), force, 0}}});
    }
    identify::Marker gauge{1, Vec3(40, 0, 0), {}};
    Experiment result{start, identify::simulate_measurements(truth, states, {gauge}, 0.005, 1), {1, 3}, {10, 10}};
    result.set.name = start.name;
    result.set.position_noise = 0.005;
    for (identify::LoadState& state : result.set.states) {
        for (identify::Reading& reading : state.readings) {
            reading.position = (state.contacts[0].force.array() == 0).select(identify::missing, reading.position);
        }
    }
    return result;
}

}  // namespace palpate::samples
