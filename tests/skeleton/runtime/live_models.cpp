#include "tests/skeleton/runtime/live_models.h"

#include <algorithm>

namespace palpate::runtime {

namespace {

// On the four nearest spheres by distance, with a part of their motion against one another.
skeleton::Attachment on_nearest(const skeleton::Model& model, const Vec3& at, std::mt19937_64& engine) {
    std::vector<int> near(model.spheres.size());
    for (std::size_t i = 0; i < near.size(); ++i) near[i] = static_cast<int>(i);
    std::ranges::sort(near, {}, [&](int i) { return (model.spheres[i].center - at).norm(); });
    skeleton::Attachment point{{}, at};
    double sum = 0;
    for (int n = 0; n < 4; ++n) {
        skeleton::SphereInfluence share{.sphere = near[n],
                                        .weight = 1 / (1 + (model.spheres[near[n]].center - at).norm())};
        sum += share.weight;
        point.shares.push_back(share);
    }
    for (skeleton::SphereInfluence& share : point.shares) {
        share.weight /= sum;
        share.follow << share.weight * Mat3::Identity(),
            -share.weight * skeleton::skew(at - model.spheres[share.sphere].center);
        for (double& entry : share.follow.reshaped()) entry += 0.1 * skeleton::testing::random_vector(engine, 1).x();
    }
    return point;
}

void attach_skin(skeleton::Model& model) {
    std::mt19937_64 engine(11);
    model.skin.clear();
    for (const auto& vertex : model.surface.vertices.rowwise()) {
        model.skin.push_back(on_nearest(model, vertex.transpose(), engine));
    }
}

}  // namespace

void give_skin(skeleton::Model& model) {
    Vec3 low = model.spheres.front().center, high = low;
    for (const skeleton::Sphere& sphere : model.spheres) {
        low = low.cwiseMin(sphere.center);
        high = high.cwiseMax(sphere.center);
    }
    low.array() -= 4;
    high.array() += 4;
    model.surface = mesh::make_box(low, high, {6, 6, 4});
    attach_skin(model);
    model.supports = {mesh::BoxRegion{low - Vec3(1, 1, 1), Vec3(low.x() + 3, high.y() + 1, high.z() + 1)}};
}

void add_cavity(skeleton::Model& model) {
    mesh::Surface hole = mesh::make_box({6, 6, 2}, {14, 14, 8}, {2, 2, 2});
    hole.triangles.col(1).swap(hole.triangles.col(2));
    const Eigen::Index before = model.surface.vertices.rows(), triangles = model.surface.triangles.rows();
    mesh::Surface both;
    both.vertices.resize(before + hole.vertices.rows(), 3);
    both.vertices << model.surface.vertices, hole.vertices;
    both.triangles.resize(triangles + hole.triangles.rows(), 3);
    both.triangles << model.surface.triangles, (hole.triangles.array() + static_cast<int>(before)).matrix();
    model.surface = both;
    attach_skin(model);
}

std::vector<skeleton::EffectRecord> playable_effects() {
    return {
        {"gravity", {{"gx", 500, ""}, {"gy", -2000, ""}, {"gz", -9810, ""}}},
        {"stiffening", {{"c2", 3, ""}, {"c3", 20, ""}}},
        {"anisotropy", {{"k", 2, ""}, {"nx", 1, ""}, {"ny", 0.5, ""}, {"nz", 0.2, ""}}},
        {"inclusion", {{"cx", 10, ""}, {"cy", 10, ""}, {"cz", 5, ""}, {"radius", 6, ""}, {"ratio", 8, ""}}},
        {"map",
         {{"length", 8, ""},
          {"x1", 8, ""},
          {"y1", 8, ""},
          {"z1", 5, ""},
          {"a1", 0.5, ""},
          {"x2", 20, ""},
          {"y2", 6, ""},
          {"z2", 5, ""},
          {"a2", 0.3, ""}}},
        {"prestress",
         {{"sxx", 0.05, ""}, {"syy", -0.02, ""}, {"szz", 0, ""}, {"sxy", 0.03, ""}, {"syz", 0, ""}, {"sxz", 0, ""}}},
        {"swelling", {{"growth", 0.03, ""}}},
        {"torsion", {{"torsion", 0.7, ""}}},
        {"shear", {{"shear", 0.4, ""}}},
        {"plasticity", {{"yield", 0.02, ""}, {"hardening", 0.1, ""}}},
        {"damage", {{"share", 0.6, ""}, {"strain", 0.03, ""}}},
        {"contact", {{"nx", 0, ""}, {"ny", 0, ""}, {"nz", 1, ""}, {"offset", -3.5, ""}, {"stiffness", 0.01, ""}}},
        {"compliant-support", {{"stiffness", 20, ""}}},
        {"local-force",
         {{"cx", 16, ""},
          {"cy", 8, ""},
          {"cz", 5, ""},
          {"radius", 4, ""},
          {"fx", 0.05, ""},
          {"fy", 0.02, ""},
          {"fz", -0.1, ""}}},
        {"local-springs", {{"cx", 16, ""}, {"cy", 8, ""}, {"cz", 8, ""}, {"radius", 5, ""}, {"stiffness", 0.3, ""}}},
        {"local-swelling", {{"cx", 12, ""}, {"cy", 8, ""}, {"cz", 5, ""}, {"radius", 6, ""}, {"growth", 0.08, ""}}}};
}

}  // namespace palpate::runtime
