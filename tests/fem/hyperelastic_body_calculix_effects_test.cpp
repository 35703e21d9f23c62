// Effects against CalculiX: the same mesh, material and loads.

#include "beam.h"
#include "calculix.h"
#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/stiffening.h"
#include "fem/effects/point/contact.h"
#include "hollow.h"
#include "point_potentials.h"

namespace palpate::fem {
namespace {

/// A beam, clamped, its end pulled and pushed sideways.
struct Loaded {
    Beam beam{{30, 6, 6}, {8, 2, 2}};
    HyperelasticBody body = beam.body(Dilatation::full);
    std::string mesh = calculix::mesh_of(beam.mesh, beam.held);
    Eigen::Index nodes = beam.mesh.nodes.rows();
};

/// How far apart two answers are, by the norm of theirs; told, too.
double apart(const Eigen::VectorXd& ours, const Eigen::VectorXd& theirs) {
    const double share = relative(ours, theirs);
    testing::Test::RecordProperty("apart", fmt::format("{:.2e}", share));
    fmt::print("             apart by {:.1e} of {:.3g} mm at most\n", share,
               theirs.reshaped(3, theirs.size() / 3).colwise().norm().maxCoeff());
    return share;
}

/// Elements, and their sides by CalculiX' count, both from 1, whose corners are all at such places.
std::vector<std::array<Eigen::Index, 2>> sides(const mesh::VolumeMesh& mesh,
                                               const std::function<bool(const Vec3&)>& here) {
    constexpr int corners[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    std::vector<std::array<Eigen::Index, 2>> found;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        for (Eigen::Index side = 0; side < 4; ++side) {
            bool all = true;
            for (const int k : corners[side]) all = all && here(mesh.nodes.row(mesh.tetrahedra(e, k)));
            if (all) found.push_back({e + 1, side + 1});
        }
    }
    return found;
}

// CalculiX stops at half a per cent of the mean force, and prints 7 digits.
constexpr double three_digits = 1e-3;

TEST(CalculiX, StiffensAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    const Loaded bar;
    const Material material{.young = 0.1, .poisson = 0.4, .density = 0};
    const double c2 = 1.5, c3 = 4, mu = material.shear_modulus(), K = 0.1 / 0.6;
    const Eigen::VectorXd f = bar.beam.end_force({0.9, 0.05, -0.05});
    const std::string yeoh =
        fmt::format("*MATERIAL, NAME=SOFT\n*HYPERELASTIC, YEOH\n{:.12g}, {:.12g}, {:.12g}, {:.12g}, 1e20, 1e20\n",
                    mu / 2, c2 * mu, c3 * mu, 2 / K);
    const std::string input = bar.mesh + yeoh + calculix::section("BODY", "SOFT") + calculix::step(calculix::forces(f));
    const Eigen::VectorXd theirs = calculix::run(input, bar.nodes).back();
    const BodySetting plain{MaterialLaw::neo_hookean, material, {}};
    BodySetting stiffening = plain;
    stiffening.effects.material = {std::make_shared<Stiffening>(c2, c3)};
    EXPECT_LT(apart(bar.body.equilibrium(stiffening, f).u, theirs), three_digits);
    EXPECT_GT(relative(bar.body.equilibrium(plain, f).u, theirs), 0.1);
}

TEST(CalculiX, OrthotropicBodiesBendAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    // Fibres along the axes of a turned frame are what engineers call orthotropic.
    const Loaded bar;
    const Material material{.young = 0.1, .poisson = 0.3, .density = 0};
    const Mat3 axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Vec3 k(4, 1, 0.5);
    const double mu = material.shear_modulus(), lambda = material.lame_lambda();
    const Vec3 C = Vec3::Constant(lambda + 2 * mu) + mu * k;
    const Eigen::VectorXd f = bar.beam.end_force({0.01, 0.001, -0.002});
    std::string input = bar.mesh;
    input += fmt::format("*ORIENTATION, NAME=FIBRES\n{:.12g}, {:.12g}, {:.12g}, {:.12g}, {:.12g}, {:.12g}\n",
                         axes(0, 0), axes(1, 0), axes(2, 0), axes(0, 1), axes(1, 1), axes(2, 1));
    input += fmt::format(
        "*MATERIAL, NAME=SOFT\n*ELASTIC, TYPE=ORTHO\n{0:.12g}, {3:.12g}, {1:.12g}, {3:.12g}, {3:.12g}, {2:.12g}, "
        "{4:.12g}, {4:.12g}\n{4:.12g}\n",
        C(0), C(1), C(2), lambda, mu);
    input += "*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT, ORIENTATION=FIBRES\n*STEP\n*STATIC\n" + calculix::forces(f) +
             "*NODE PRINT, NSET=ALL\nU\n*END STEP\n";
    const Eigen::VectorXd theirs = calculix::run(input, bar.nodes).back();
    const BodySetting plain{MaterialLaw::linear, material, {}};
    BodySetting fibres = plain;
    fibres.effects.material = {std::make_shared<Anisotropy>(
        std::vector<Fibre>{{k(0), axes.col(0)}, {k(1), axes.col(1)}, {k(2), axes.col(2)}})};
    EXPECT_LT(apart(bar.body.equilibrium(fibres, f).u, theirs), 1e-5);  // seven digits
    EXPECT_GT(relative(bar.body.equilibrium(plain, f).u, theirs), 0.1);
}

TEST(CalculiX, InclusionsStiffenAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    // Slices of one cell each: no quadrature point lies in the smooth borders, so that two sets of elements are the
    // same.
    const Loaded bar;
    const Material soft{.young = 0.1, .poisson = 0.4, .density = 0};
    const double ratio = 6, cell = 30.0 / 8;
    Material hard = soft;
    hard.young *= ratio;
    std::vector<std::shared_ptr<const MaterialEffect>> slices;
    std::string sets = "*ELSET, ELSET=HARD\n";
    std::string rest = "*ELSET, ELSET=SOFTER\n";
    for (const int i : {1, 2, 5}) {
        slices.push_back(
            std::make_shared<Inclusion>(Inclusion::box({(i + 0.5) * cell, 0, 0}, {cell / 2, 100, 100}, ratio)));
    }
    for (Eigen::Index e = 0; e < bar.beam.mesh.tetrahedra.rows(); ++e) {
        double x = 0;
        for (int k = 0; k < 4; ++k) x += bar.beam.mesh.nodes(bar.beam.mesh.tetrahedra(e, k), 0) / 4;
        const int slice = static_cast<int>(x / cell);
        (slice == 1 || slice == 2 || slice == 5 ? sets : rest) += fmt::format("{},\n", e + 1);
    }
    const Eigen::VectorXd f = bar.beam.end_force({0.05, 0.02, -0.06});
    const std::string input = bar.mesh + sets + rest + calculix::neo_hookean("STIFF", hard) +
                              calculix::neo_hookean("SOFT", soft) + calculix::section("HARD", "STIFF") +
                              calculix::section("SOFTER", "SOFT") + calculix::step(calculix::forces(f));
    const Eigen::VectorXd theirs = calculix::run(input, bar.nodes).back();
    const BodySetting setting{MaterialLaw::neo_hookean, soft, {.material = slices}};
    EXPECT_LT(apart(bar.body.equilibrium(setting, f).u, theirs), three_digits);
    EXPECT_GT(relative(bar.body.equilibrium({MaterialLaw::neo_hookean, soft, {}}, f).u, theirs), 0.1);
}

TEST(CalculiX, HollowBodiesSwellAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    const auto mesh = spherical_shell(6, 10, 2, 1);
    const std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.z() < -8; });
    const Material material{.young = 0.1, .poisson = 0.4, .density = 0};
    const double p = 0.01;
    std::string loads = "*DLOAD\n";
    for (const auto& [element, side] : sides(mesh, [](const Vec3& x) { return x.norm() < 6 + 1e-9; }))
        loads += fmt::format("{}, P{}, {}\n", element, side, p);
    const std::string input = calculix::mesh_of(mesh, held) + calculix::neo_hookean("SOFT", material) +
                              calculix::section("BODY", "SOFT") + calculix::step(loads);
    const Eigen::VectorXd theirs = calculix::run(input, mesh.nodes.rows()).back();
    EXPECT_GT(theirs.cwiseAbs().maxCoeff(), 1);
    const HyperelasticBody body(mesh, held, Dilatation::full);
    const BodySetting setting{MaterialLaw::neo_hookean, material, {.pressure = p}};
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(theirs.size());
    // They sum pressure over three points of a curved face; exact here.
    EXPECT_LT(apart(body.equilibrium(setting, none).u, theirs), 0.005);
}

TEST(CalculiX, PlanesAreSpringsOnOneSide) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    // The same sum over nodes: each stands on a long spring that bears once the node is a gap below where it rests.
    const Loaded bar;
    const Material material{.young = 0.1, .poisson = 0.4, .density = 0};
    const double gap = 1, k = 0.05, length = 1e4;
    const Eigen::VectorXd f = bar.beam.end_force({0, 0, -0.1});
    std::string springs;
    const NodeWeights skin = bar.body.points(ActsOn::surface, 0);
    for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
        const double slope = k * skin.weights(static_cast<Eigen::Index>(i));
        const Vec3 X = bar.beam.mesh.nodes.row(skin.nodes[i]);
        const double reach = gap + X.z();
        if (reach > 4 || slope < 1e-9) continue;  // it stays above, or is a corner, which stands for no area
        const std::size_t own = 10000 + i;
        springs += fmt::format("*NODE\n{0}, {1:.12g}, {2:.12g}, {3:.12g}\n*BOUNDARY\n{0}, 1, 3\n", own, X.x(), X.y(),
                               X.z() - length);
        springs += fmt::format("*ELEMENT, TYPE=SPRINGA, ELSET=S{0}\n{0}, {1}, {0}\n*SPRING, ELSET=S{0}, NONLINEAR\n\n",
                               own, skin.nodes[i] + 1);
        springs += fmt::format("{:.12g}, {:.12g}\n0., {:.12g}\n0., 100.\n", -10 * slope, -reach - 10, -reach);
    }
    const std::string input = bar.mesh + springs + calculix::neo_hookean("SOFT", material) +
                              calculix::section("BODY", "SOFT") + calculix::step(calculix::forces(f));
    const Eigen::VectorXd theirs = calculix::run(input, bar.nodes).back();
    const BodySetting free{MaterialLaw::neo_hookean, material, {}};
    BodySetting leaning = free;
    leaning.effects.points = {std::make_shared<ContactPlane>(Vec3(0, 0, 1), -gap, k)};
    EXPECT_LT(apart(bar.body.equilibrium(leaning, f).u, theirs), three_digits);
    EXPECT_GT(relative(bar.body.equilibrium(free, f).u, theirs), 0.5);
}

TEST(CalculiX, BallsComeToRestOnAPlaneAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    // A hollow ball hangs from its top, and sags under its weight on a plate that is held; pressure k times the depth.
    const auto mesh = spherical_shell(5, 10, 2, 2);
    const std::vector<char> held = nodes_where(mesh, [](const Vec3& x) { return x.z() > 7; });
    const Material material{.young = 0.1, .poisson = 0.4, .density = 1e-9};
    const double ground = -10.3, k = 0.3, g = 3e6;
    const Eigen::Index nodes = mesh.nodes.rows(), plate = mesh.tetrahedra.rows() + 1;
    std::string contact = "*NODE, NSET=PLATE\n";
    for (int i = 0; i < 8; ++i) {
        contact += fmt::format("{}, {}, {}, {}\n", nodes + 1 + i, i % 4 == 1 || i % 4 == 2 ? 40 : -40,
                               i % 4 >= 2 ? 40 : -40, ground - (i < 4 ? 5 : 0));
    }
    contact += fmt::format("*ELEMENT, TYPE=C3D8, ELSET=PLATE\n{}", plate);
    for (int i = 0; i < 8; ++i) contact += fmt::format(", {}", nodes + 1 + i);
    contact += fmt::format("\n*BOUNDARY\nPLATE, 1, 3\n*SURFACE, NAME=GROUND\n{}, S2\n*SURFACE, NAME=UNDER\n", plate);
    for (const auto& [element, side] : sides(mesh, [](const Vec3& x) { return x.norm() > 10 - 1e-9 && x.z() < 0; }))
        contact += fmt::format("{}, S{}\n", element, side);
    contact += fmt::format("*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{}\n", k);
    contact += "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\nUNDER, GROUND\n";
    const std::string input = calculix::mesh_of(mesh, held) + calculix::neo_hookean("SOFT", material) +
                              calculix::section("BODY", "SOFT") + contact + calculix::section("PLATE", "SOFT") +
                              calculix::step(fmt::format("*DLOAD\nBODY, GRAV, {}, 0., 0., -1.\n", g), 0.5);
    const Eigen::VectorXd theirs = calculix::run(input, nodes).back(), none = Eigen::VectorXd::Zero(3 * nodes);
    const HyperelasticBody body(mesh, held, Dilatation::full);
    BodySetting setting{MaterialLaw::neo_hookean, material, {.points = {std::make_shared<Weight>(Vec3(0, 0, -g))}}};
    EXPECT_GT(relative(body.equilibrium(setting, none).u, theirs), 0.5);
    setting.effects.points.push_back(std::make_shared<ContactPlane>(Vec3(0, 0, 1), ground, k));
    // They sum over points of the bent skin, we over nodes by their area at rest; on a mesh twice as coarse it is 7 %.
    EXPECT_LT(apart(body.equilibrium(setting, none).u, theirs), 0.02);
}

TEST(CalculiX, YieldingBodiesBendAndStaySetAlike) {
    if (!calculix::installed()) GTEST_SKIP() << calculix::missing;
    const Loaded bar;
    const Material material{.young = 0.1, .poisson = 0.3, .density = 0};
    const Plasticity plasticity{.yield = 0.02, .hardening = 0.3};
    const double mises = 3 * material.shear_modulus();
    const Eigen::VectorXd f = bar.beam.end_force({0.02, 0.01, -0.03}), none = Eigen::VectorXd::Zero(f.size());
    std::string input = bar.mesh;
    input +=
        fmt::format("*MATERIAL, NAME=SOFT\n*ELASTIC\n{}, {}\n*PLASTIC\n{:.12g}, 0.\n{:.12g}, 10.\n", material.young,
                    material.poisson, mises * plasticity.yield, mises * (plasticity.yield + 10 * plasticity.hardening));
    input += calculix::section("BODY", "SOFT") + calculix::step(calculix::forces(f)) +
             calculix::step(calculix::forces(none), 0.5);
    const auto theirs = calculix::run(input, bar.nodes);
    ASSERT_EQ(theirs.size(), 2U);

    BodySetting setting{MaterialLaw::neo_hookean, material, {}};
    EXPECT_GT(relative(bar.body.equilibrium(setting, f).u, theirs[0]), 0.1);
    setting.effects.plasticity = plasticity;
    for (const int steps : {10, 1}) {
        std::shared_ptr<const MaterialState> state;
        Eigen::VectorXd u = none;
        for (int k = 1; k <= steps; ++k) {
            u = bar.body.equilibrium(setting, f * k / steps, {}, &u, state.get()).u;
            state = bar.body.state_after(u, setting, state.get());
        }
        EXPECT_LT(apart(u, theirs[0]), 0.01);
        EXPECT_LT(apart(bar.body.equilibrium(setting, none, {}, &u, state.get()).u, theirs[1]), 0.01);
    }
    EXPECT_GT(theirs[1].norm(), 0.1 * theirs[0].norm());
}

}  // namespace
}  // namespace palpate::fem
