// Against CalculiX: the same mesh, law and loads.

#include "calculix.h"

#include "beam.h"
#include "point_potentials.h"

namespace palpate::fem {
namespace {

/// Largest displacement along -z.
double sag(const Eigen::VectorXd& u) { return -u.reshaped(3, u.size() / 3).row(2).minCoeff(); }

// CalculiX prints 7 digits and stops at half a per cent of the mean force, after a last correction of a millionth or
// so. Its standard quadratic tetrahedra take the volume as the displacements have it: Dilatation::full.
constexpr double four_digits = 1e-4;

TEST(CalculiX, CantileverBendsAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    const Beam beam({50, 8, 8}, {10, 2, 2});
    const Material material{.young = 0.2, .poisson = 0.4, .density = 0};
    Eigen::VectorXd f = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i) {
        if (beam.mesh.nodes(i, 0) > 50 - 1e-9) f.segment<3>(3 * i) = Vec3(2e-4, 6e-4, -2.2e-3);
    }
    const std::string input = calculix::mesh_of(beam.mesh, beam.held) + calculix::neo_hookean("SOFT", material) +
                              calculix::section("BODY", "SOFT") + calculix::step(calculix::forces(f));
    const Eigen::VectorXd theirs = calculix::run(input, beam.mesh.nodes.rows()).back();
    EXPECT_GT(sag(theirs), 0.3 * 50);
    EXPECT_LT(relative(beam.body(Dilatation::full).equilibrium({MaterialLaw::neo_hookean, material, {}}, f).u, theirs),
              four_digits);
}

TEST(CalculiX, BarSagsAlikeUnderItsWeight) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    const Beam beam({40, 10, 10}, {8, 2, 2});
    const Material material{.young = 0.02, .poisson = 0.45, .density = 1e-9};
    const double g = 9810;
    const std::string input = calculix::mesh_of(beam.mesh, beam.held) + calculix::neo_hookean("SOFT", material) +
                              calculix::section("BODY", "SOFT") +
                              calculix::step(fmt::format("*DLOAD\nBODY, GRAV, {}, 0., 0., -1.\n", g));
    const Eigen::VectorXd theirs = calculix::run(input, beam.mesh.nodes.rows()).back();
    EXPECT_GT(sag(theirs), 0.1 * 40);
    const BodySetting setting{
        MaterialLaw::neo_hookean, material, {.points = {std::make_shared<Weight>(Vec3(0, 0, -g))}}};
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(theirs.size());
    EXPECT_LT(relative(beam.body(Dilatation::full).equilibrium(setting, none).u, theirs), four_digits);
}

}  // namespace
}  // namespace palpate::fem
