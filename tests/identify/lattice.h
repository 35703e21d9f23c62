#pragma once

#include <algorithm>
#include <vector>

#include "identify/loading/twin.h"
#include "skeleton/model/model.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

/// A lattice of n(x,y,z) spheres 40 mm apart, links between neighbours, held at x = 0, as in [Burion 2008, section IV].
/// Stiffness: kE 2 N/mm, kF 750 N mm/rad, kT 500 N mm/rad. Zones: `zones` of even length along x.
inline skeleton::Model make_lattice(const Eigen::Vector3i& n, int zones = 1) {
    constexpr double spacing = 40;
    skeleton::Model model;
    model.name = "lattice";
    const auto index = [&](int i, int j, int k) { return (i * n.y() + j) * n.z() + k; };
    for (int i = 0; i < n.x(); ++i) {
        for (int j = 0; j < n.y(); ++j) {
            for (int k = 0; k < n.z(); ++k) {
                skeleton::Sphere sphere;
                sphere.center = spacing * Vec3(i, j, k);
                sphere.radius = 10;
                sphere.mass = 1e-6;
                sphere.inertia = 4e-5 * Mat3::Identity();
                sphere.held = i == 0;
                model.spheres.push_back(sphere);
                const auto join = [&](int other, int zone) {
                    model.links.push_back({index(i, j, k), other, spacing, Vec3(2, 750, 500), zone, 0, {}});
                };
                if (i + 1 < n.x()) join(index(i + 1, j, k), i * zones / (n.x() - 1));
                if (j + 1 < n.y()) join(index(i, j + 1, k), std::min(zones - 1, i * zones / (n.x() - 1)));
                if (k + 1 < n.z()) join(index(i, j, k + 1), std::min(zones - 1, i * zones / (n.x() - 1)));
            }
        }
    }
    return model;
}

inline skeleton::Model with_law(skeleton::Model model, skeleton::EquilibriumLaw law) {
    model.law = law;
    return model;
}

/// The same with kE and kF of each zone.
inline skeleton::Model with_truth(skeleton::Model model, const std::vector<double>& kE, const std::vector<double>& kF) {
    for (skeleton::Link& link : model.links) {
        link.stiffness[0] = kE[link.zone];
        link.stiffness[1] = kF[link.zone];
    }
    return model;
}

/// Six forces [N], of `across` along z and `along` in the plane x, y: a sheet gives way to the former far more.
inline std::vector<Vec3> six_forces(double across, double along) {
    return {{0, 0, -across}, {along, 0, 0},  {0, along, 0},
            {0, 0, across},  {-along, 0, 0}, {0.8 * along, -0.6 * along, 0}};
}

/// A state for each force, on one free sphere after the other.
inline std::vector<LoadState> push_spheres(const skeleton::Model& model, const std::vector<Vec3>& forces) {
    std::vector<int> free;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (!model.spheres[i].held) free.push_back(i);
    }
    std::vector<LoadState> result;
    std::size_t next = free.size() - 1;
    for (const Vec3& force : forces) {
        LoadState state;
        state.probe = static_cast<int>(result.size()) + 1;
        state.time = 1;
        state.contacts.push_back({model.spheres[free[next]].center, force, 0});
        result.push_back(state);
        next = (next + 7) % free.size();
    }
    return result;
}

}  // namespace palpate::identify
