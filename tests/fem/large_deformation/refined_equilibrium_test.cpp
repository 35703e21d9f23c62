#include "fem/large_deformation/refined_equilibrium.h"

#include "fem/effects/point/compliant_support.h"
#include "fem/elements/patch_load.h"
#include "fem/interpolation/refine.h"
#include "tests/fem/bodies.h"

namespace palpate::fem {
namespace {

/// A strip of one element in thickness, held at x = 0, under a load on its end that bends it by an eighth of its
/// length.
class RefinedEquilibrium : public testing::Test {
protected:
    static std::vector<char> held(const mesh::VolumeMesh& mesh) {
        return nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; });
    }
    Eigen::VectorXd load(const mesh::VolumeMesh& mesh, double force = -0.0005) const {
        return Eigen::VectorXd(patch_loads(mesh, {{Vec3(38, 5, 2), Vec3(0, 0, force), 4}}, 40).col(0));
    }

    const mesh::VolumeMesh mesh_ = jittered_bar(Kind::quadratic, Vec3(40, 10, 2), {6, 2, 1});
    const HyperelasticBody coarse_{mesh_, held(mesh_)};
    const RefinedMesh refined_ = refine(mesh_);
    const HyperelasticBody fine_{refined_.mesh, held(refined_.mesh)};
    const BodySetting setting_{MaterialLaw::neo_hookean, {.young = 0.3, .poisson = 0.45}, {}};
};

TEST_F(RefinedEquilibrium, IsThatOfTheFinerMesh) {
    const Eigen::VectorXd u = coarse_.equilibrium(setting_, load(mesh_)).u;
    const auto found = refined_equilibrium({fine_, refined_.interpolation}, u, *coarse_.factor(u, setting_), setting_,
                                           load(refined_.mesh));
    ASSERT_TRUE(found);
    const Eigen::VectorXd exact = fine_.equilibrium(setting_, load(refined_.mesh)).u;
    const Points interpolated = refined_.interpolation * Eigen::Map<const Points>(u.data(), u.size() / 3, 3);
    const Eigen::Map<const Eigen::VectorXd> start(interpolated.data(), interpolated.size());
    // Up to 1.4 % of what it begins with.
    EXPECT_LT((*found - exact).norm(), 0.015 * (start - exact).norm());
    // Which is no rounding: such a mesh is off by some per cent.
    EXPECT_GT((start - exact).norm(), 0.01 * exact.norm());
}

TEST_F(RefinedEquilibrium, IsNoneWhereItIsNotFound) {
    const Eigen::VectorXd u = coarse_.equilibrium(setting_, load(mesh_)).u;
    const auto tangent = coarse_.factor(u, setting_);
    // A thousand times the load, on a tip, turns elements inside out.
    EXPECT_FALSE(refined_equilibrium({fine_, refined_.interpolation}, u, *tangent, setting_, load(refined_.mesh, -2)));
    BodySetting released = setting_;
    released.effects.points = {std::make_shared<CompliantSupport>(0.1)};
    EXPECT_FALSE(refined_equilibrium({fine_, refined_.interpolation}, u, *tangent, released, load(refined_.mesh)));
}

}  // namespace
}  // namespace palpate::fem
