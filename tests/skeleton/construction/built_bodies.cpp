#include "built_bodies.h"

#include <algorithm>
#include <numeric>

#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::skeleton::built_bodies {

mesh::VolumeMesh carve(const mesh::VolumeMesh& bar, const Eigen::Vector3i& cells, const Vec3& size,
                       const std::function<bool(const Vec3&)>& shape) {
    std::vector<int> kept;
    const Vec3 step = size.cwiseQuotient(cells.cast<double>());
    for (int t = 0; t < bar.tetrahedra.rows(); ++t) {
        Vec3 center = Vec3::Zero();
        for (int c = 0; c < 4; ++c) center += bar.nodes.row(bar.tetrahedra(t, c)).transpose() / 4;
        const Vec3 cell = (center.cwiseQuotient(step).array().floor() + 0.5).matrix().cwiseProduct(step);
        if (shape(cell)) kept.push_back(t);
    }
    mesh::VolumeMesh body;
    body.tetrahedra.resize(static_cast<Eigen::Index>(kept.size()), 4);
    std::vector<int> index(bar.nodes.rows(), -1);
    std::vector<Vec3> nodes;
    for (std::size_t t = 0; t < kept.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            int& node = index[bar.tetrahedra(kept[t], c)];
            if (node < 0) {
                node = static_cast<int>(nodes.size());
                nodes.push_back(bar.nodes.row(bar.tetrahedra(kept[t], c)));
            }
            body.tetrahedra(static_cast<Eigen::Index>(t), c) = node;
        }
    }
    body.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
    for (std::size_t i = 0; i < nodes.size(); ++i) body.nodes.row(static_cast<Eigen::Index>(i)) = nodes[i];
    body.faces = mesh::boundary_faces(body.tetrahedra);
    return body;
}

mesh::VolumeMesh block(const Vec3& size, const Eigen::Vector3i& cells) {
    return mesh::make_bar(Vec3::Zero(), size, cells);
}

std::vector<mesh::Region> clamp() { return {mesh::BoxRegion{Vec3(-0.1, -1e3, -1e3), Vec3(0.1, 1e3, 1e3)}}; }

Built build(const mesh::VolumeMesh& body, const BuildOptions& options, const std::vector<mesh::Region>& supports,
            const fem::Material& material) {
    Built built;
    built.surface = mesh::boundary_surface(body);
    built.model = build_skeleton(built.surface, body, material, supports, options, &built.report);
    return built;
}

int free_spheres(const Model& model) {
    return static_cast<int>(std::count_if(model.spheres.begin(), model.spheres.end(), [](auto& s) { return !s.held; }));
}

int components(const Model& model) {
    std::vector<int> part(model.spheres.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](int i) {
        while (part[i] != i) i = part[i];
        return i;
    };
    for (const Link& link : model.links) part[root(link.a)] = root(link.b);
    int count = 0;
    for (int i = 0; i < static_cast<int>(part.size()); ++i) count += part[i] == i;
    return count;
}

int loops(const Model& model) {
    return static_cast<int>(model.links.size()) - static_cast<int>(model.spheres.size()) + components(model);
}

mesh::VolumeMesh limb() { return block(limb_size, {40, 4, 4}); }
mesh::VolumeMesh plate() { return block(plate_size, {25, 20, 2}); }
mesh::VolumeMesh lump() { return block(lump_size, {12, 8, 8}); }

const Built& built_limb() {
    static const Built built = build(limb());
    return built;
}
const Built& built_plate() {
    static const Built built = build(plate());
    return built;
}
const Built& built_lump() {
    static const Built built = build(lump());
    return built;
}

double give(const Model& built, const Vec3& tip, const Vec3& direction) {
    Model model = built;
    model.law = EquilibriumLaw::linear;
    const Attachment end = attach(model, tip);
    Load load;
    load.forces.push_back({end, 1e-3 * direction});
    return direction.dot(observe(model, equilibrium(model, load), {end}).row(0).transpose() - tip);
}
double sag(const Model& built, const Vec3& tip) { return give(built, tip, -Vec3::UnitZ()); }

}  // namespace palpate::skeleton::built_bodies
