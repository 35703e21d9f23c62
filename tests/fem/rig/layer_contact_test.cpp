// Tools that press on a layer, against the exact answers.

#include "tests/fem/rig/layer_contact.h"

#include <gtest/gtest.h>

#include "fem/elements/shape.h"
#include "tests/fem/rig/rigged_bar.h"

namespace palpate::fem {
namespace {

/// A disc of the layer z in [-h, 0], bonded at its lower side: rings of 16 sectors, finer towards the radius a.
mesh::VolumeMesh layer(double h, double a, double outer, int rings, int layers) {
    constexpr int sectors = 16;
    std::vector<double> radii;
    for (int k = 1; k <= rings; ++k) radii.push_back(a * (1 - std::pow(1 - static_cast<double>(k) / rings, 1.8)));
    for (int k = 1; k <= rings; ++k) radii.push_back(a + (outer - a) * std::pow(static_cast<double>(k) / rings, 2.2));
    std::vector<Vec3> flat{Vec3::Zero()};
    for (std::size_t k = 0; k < radii.size(); ++k) {
        for (int s = 0; s < sectors; ++s) {
            const double angle = 2 * std::numbers::pi * (s + 0.5 * static_cast<double>(k % 2)) / sectors;
            flat.push_back(radii[k] * Vec3(std::cos(angle), std::sin(angle), 0));
        }
    }
    std::vector<std::array<int, 3>> triangles;
    const auto node = [&](std::size_t ring, int s) {
        return 1 + static_cast<int>(ring) * sectors + (s + sectors) % sectors;
    };
    triangles.reserve(2 * radii.size() * sectors);
    for (int s = 0; s < sectors; ++s) triangles.push_back({0, node(0, s), node(0, s + 1)});
    for (std::size_t k = 0; k + 1 < radii.size(); ++k) {
        for (int s = 0; s < sectors; ++s) {
            const int shift = k % 2 == 0 ? 0 : 1;  // an odd ring is half a sector ahead
            triangles.push_back({node(k, s), node(k, s + 1), node(k + 1, s + shift)});
            triangles.push_back({node(k, s), node(k + 1, s + shift - 1), node(k + 1, s + shift)});
        }
    }
    const int n = static_cast<int>(flat.size());
    mesh::VolumeMesh body;
    body.nodes.resize(Eigen::Index{n} * (layers + 1), 3);
    for (int l = 0; l <= layers; ++l) {
        for (int i = 0; i < n; ++i)
            body.nodes.row(Eigen::Index{l} * n + i) =
                flat[i] - Vec3(0, 0, h * std::pow(static_cast<double>(l) / layers, 1.8));
    }
    std::vector<std::array<int, 4>> tetrahedra;
    for (int l = 0; l < layers; ++l) {
        for (auto corners : triangles) {
            std::ranges::sort(corners);
            const auto& [i, j, k] = corners;
            const int low = l * n, high = low + n;
            tetrahedra.push_back({low + i, low + j, low + k, high + k});
            tetrahedra.push_back({low + i, low + j, high + k, high + j});
            tetrahedra.push_back({low + i, high + j, high + k, high + i});
        }
    }
    body.tetrahedra.resize(std::ssize(tetrahedra), 4);
    for (std::size_t e = 0; e < tetrahedra.size(); ++e)
        for (int c = 0; c < 4; ++c) body.tetrahedra(static_cast<Eigen::Index>(e), c) = tetrahedra[e][c];
    const Eigen::VectorXd volumes = mesh::element_volumes(body);
    for (Eigen::Index e = 0; e < volumes.size(); ++e)
        if (volumes(e) < 0) std::swap(body.tetrahedra(e, 0), body.tetrahedra(e, 1));
    body.faces = mesh::boundary_faces(body.tetrahedra);
    return mesh::to_quadratic(body);
}

/// Midsides of chords move out to the circle.
void round_rings(mesh::VolumeMesh& body) {
    for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
        for (int m = 0; m < 6; ++m) {
            const auto [a, b] = edge_corners[m];
            const double r = body.nodes.row(body.tetrahedra(e, a)).head<2>().norm(),
                         other = body.nodes.row(body.tetrahedra(e, b)).head<2>().norm();
            auto middle = body.nodes.row(body.tetrahedra(e, 4 + m)).head<2>();
            if (std::abs(r - other) < 1e-9 && middle.norm() > 0) middle *= r / middle.norm();
        }
    }
}

/// What an indenter at depth d bears on a layer, over the exact force in small strain.
double over_exact(const std::shared_ptr<const RigidTool>& tool, double d, double exact, const mesh::VolumeMesh& mesh,
                  double h, const Material& material) {
    const HyperelasticBody body(mesh, nodes_where(mesh, [&](const Vec3& x) { return x.z() < -h + 1e-9; }));
    const auto pressed = moved(tool, Vec3(0, 0, -d), Vec3::Zero(), material.young);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(mesh.nodes.size());
    const Eigen::VectorXd u = body.equilibrium({MaterialLaw::linear, material, {.tools = {pressed}}}, none).u;
    return -body.wrench(u, pressed).z() / exact;
}

TEST(Tool, SphereAndFlatPunchPressAsHertzAndSneddonSay) {
    // On a layer, whose thickness the exact answers know. [Hayes et al. 1972]
    const Material material{.young = 0.1, .poisson = 0.3, .density = 0};
    const double h = 6, a = 3;
    const LayerContact exact{h, material.young, material.poisson};
    mesh::VolumeMesh mesh = layer(h, a, 18, 4, 4);
    round_rings(mesh);
    const double sphere = over_exact(sphere_tool(Vec3(0, 0, 20), 20), 0.3, exact.sphere(20, 0.3), mesh, h, material);
    const double punch = over_exact(flat_tool(Vec3::Zero(), a), 0.1, exact.flat_punch(a, 0.1), mesh, h, material);
    // Elements are a fourth of the contact's radius, and finer at its border.
    EXPECT_NEAR(sphere, 1, 0.02);
    EXPECT_NEAR(punch, 1, 0.02);
}

TEST(LayerContact, KnowsHayesTable) {
    // kappa(a/h) at nu = 0.5 [Hayes et al. 1972, table 2]; to the digits of the table.
    const LayerContact layer{1, 1, 0.5};
    const double hayes[] = {1.281, 1.683, 2.211, 2.855, 3.609};
    for (int k = 0; k < 5; ++k) {
        const double a = 0.2 * (k + 1);
        EXPECT_NEAR(layer.flat_punch(a, 1) * (1 - 0.25) / (2 * a) / hayes[k], 1, 0.003);
    }
    const LayerContact thick{1e3, 1, 0.3};
    EXPECT_NEAR(thick.sphere(1, 0.01), 4.0 / 3 / 0.91 * std::pow(0.01, 1.5), 1e-3 * 1.5e-3);  // Hertz
}

}  // namespace
}  // namespace palpate::fem
