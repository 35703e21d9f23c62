#pragma once

#include <functional>
#include <vector>

#include "skeleton/construction/build.h"

namespace palpate::skeleton::built_bodies {

/// A bar of cells, of which those are kept whose middles the shape holds.
mesh::VolumeMesh carve(const mesh::VolumeMesh& bar, const Eigen::Vector3i& cells, const Vec3& size,
                       const std::function<bool(const Vec3&)>& shape);
mesh::VolumeMesh block(const Vec3& size, const Eigen::Vector3i& cells);

/// Holds the face x = 0.
std::vector<mesh::Region> clamp();

struct Built {
    mesh::Surface surface;
    Model model;
    BuildReport report;
};

Built build(const mesh::VolumeMesh& body, const BuildOptions& options = {},
            const std::vector<mesh::Region>& supports = clamp(), const fem::Material& material = {});

int free_spheres(const Model& model);
int components(const Model& model);
int loops(const Model& model);

/// Bodies of each kind: a limb, a plate, a lump.
inline const Vec3 limb_size(160, 16, 16), plate_size(100, 80, 6), lump_size(60, 40, 40);
mesh::VolumeMesh limb();
mesh::VolumeMesh plate();
mesh::VolumeMesh lump();

/// Built once, with default options.
const Built& built_limb();
const Built& built_plate();
const Built& built_lump();

/// How far the middle of the far end gives way to a force of 1 mN there, linear.
double give(const Model& built, const Vec3& tip, const Vec3& direction);
double sag(const Model& built, const Vec3& tip);

}  // namespace palpate::skeleton::built_bodies
