// What acts on a body from inside: pressure in each cavity, tendons.

#include "mesh/errors.h"
#include "tests/fem/hollow.h"
#include "tests/fem/rig/rigged_bar.h"

namespace palpate::fem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::shared_ptr<const mesh::TendonActuator> tendon(const std::vector<Vec3>& points, bool by_length) {
    Points path(std::ssize(points), 3);
    for (std::size_t k = 0; k < points.size(); ++k) path.row(static_cast<Eigen::Index>(k)) = points[k];
    return std::make_shared<mesh::TendonActuator>(mesh::TendonActuator{path, by_length});
}

std::shared_ptr<const mesh::PressureActuator> cavity(const std::variant<Vec3, mesh::Surface>& place) {
    return std::make_shared<mesh::PressureActuator>(mesh::PressureActuator{place});
}

/// A bar with two cavities and two tendons of either kind.
struct Actuated {
    mesh::VolumeMesh mesh = hollow_bar({10, 3, 3}, {5, 3, 3}, {{1, 1, 1}, {3, 1, 1}});
    HyperelasticBody body{mesh, nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })};
    Material material{.young = 0.3, .poisson = 0.4};
    std::vector<Vec3> path{{0, 0.4, 2.6}, {3.1, 0.5, 2.5}, {6.3, 0.4, 2.4}, {9.1, 0.6, 2.6}};

    BodySetting setting(MaterialLaw law) const {
        return {law,
                material,
                {.cavities = {{cavity(Vec3(7, 1.5, 1.5)), 0.02}, {cavity(Vec3(3, 1.5, 1.5)), 0.01}},
                 .tendons = {{tendon(path, false), 0.02, 0},
                             {tendon({{0, 2.5, 0.5}, {5, 2.5, 0.6}, {9, 2.4, 0.5}}, true), 0.1, material.young}}}};
    }
    Eigen::VectorXd none() const { return Eigen::VectorXd::Zero(mesh.nodes.size()); }
};

TEST(Actuators, ForcesAndTangentAreDerivativesOfTheEnergy) {
    const Actuated bar;
    for (const MaterialLaw law : laws) {
        const BodySetting setting = bar.setting(law);
        const Eigen::VectorXd u = scatter(bar.none().size(), 0.01), r = bar.body.residual(u, setting, bar.none());
        const Eigen::SparseMatrix<double> J = bar.body.tangent(u, setting);
        const TendonPull& held = setting.effects.tendons[1];
        EXPECT_GT(bar.body.tendon_state(u, held, law == MaterialLaw::linear).tension, 0);
        const Eigen::MatrixXd D = bar.body.tendon_derivative(u, held, law == MaterialLaw::linear);
        for (unsigned seed = 1; seed < 4; ++seed) {
            const Eigen::VectorXd step = scatter(u.size(), 1, seed);
            const double h = 1e-6;
            const auto along = [&](const auto& value) {
                return Eigen::VectorXd((value(u + h * step) - value(u - h * step)) / (2 * h));
            };
            // Differences of step 1e-6 carry seven digits of what is large.
            const auto energy = [&](const Eigen::VectorXd& at) {
                return Eigen::VectorXd::Constant(1, bar.body.potential(at, setting, bar.none())).eval();
            };
            EXPECT_NEAR(along(energy)(0), -r.dot(step), 1e-6 * r.norm() * step.norm());
            const auto residual = [&](const Eigen::VectorXd& at) { return bar.body.residual(at, setting, bar.none()); };
            EXPECT_LT((along(residual) + J * step).norm(), 1e-6 * (J * step).norm());
            const auto state = [&](const Eigen::VectorXd& at) {
                const TendonState now = bar.body.tendon_state(at, held, law == MaterialLaw::linear);
                return Eigen::VectorXd(Eigen::Vector2d(now.drawn_in, now.tension));
            };
            EXPECT_LT((along(state) - D.transpose() * step).norm(), 1e-6 * (D.transpose() * step).norm());
        }
    }
}

TEST(Actuators, SolveInvertsTheTangent) {
    const Actuated bar;
    const BodySetting setting = bar.setting(MaterialLaw::neo_hookean);
    const BodyEquilibrium found = bar.body.equilibrium(setting, bar.none());
    Eigen::VectorXd b = scatter(found.u.size(), 1);
    for (std::size_t i = 0; i < bar.body.held().size(); ++i)
        if (bar.body.held()[i]) b.segment<3>(3 * i).setZero();
    const Eigen::VectorXd x = bar.body.factor(found.u, setting)->solve(b);
    Eigen::VectorXd back = bar.body.tangent(found.u, setting) * x;
    for (std::size_t i = 0; i < bar.body.held().size(); ++i)
        if (bar.body.held()[i]) back.segment<3>(3 * i).setZero();
    EXPECT_LT(relative(back, b), 1e-9);  // rounding times the condition, of some 1e5
}

TEST(Actuators, CavitiesAreFoundByPointAndBySurface) {
    const Actuated bar;
    const Eigen::VectorXd volumes = bar.body.cavity_volumes(bar.none());
    ASSERT_EQ(volumes.size(), 2);
    EXPECT_LT((volumes - Eigen::Vector2d(2, 2)).norm(), 1e-13);  // rounding
    const int left = bar.body.find_cavity(*cavity(Vec3(2.4, 1.5, 1.4))), right = 1 - left;
    EXPECT_EQ(bar.body.find_cavity(*cavity(Vec3(9, 0, 0))), right);
    const mesh::Surface chamber = mesh::make_box(Vec3(6, 1, 1), Vec3(8, 2, 2), Eigen::Vector3i(3, 2, 2));
    EXPECT_EQ(bar.body.find_cavity(*cavity(chamber)), right);
    // Pressure in one swells that one.
    const BodySetting setting{MaterialLaw::neo_hookean, bar.material, {.cavities = {{cavity(chamber), 0.03}}}};
    const Eigen::VectorXd swollen = bar.body.cavity_volumes(bar.body.equilibrium(setting, bar.none()).u) - volumes;
    EXPECT_GT(swollen[right], 0.1);
    EXPECT_LT(std::abs(swollen[left]), 0.1 * swollen[right]);
    // In both alike it is the pressure of the body.
    BodySetting both = setting, whole = setting;
    both.effects.cavities.push_back({cavity(Vec3(2, 1.5, 1.5)), 0.03});
    whole.effects = {.pressure = 0.03};
    EXPECT_LT(relative(bar.body.equilibrium(both, bar.none()).u, bar.body.equilibrium(whole, bar.none()).u), 1e-12);
}

TEST(Tendon, BendsABeamToAnArc) {
    // A tendon at the distance d from the axis bends a slender beam of stiffness EI to the curvature T d / EI', where
    // the tension also presses it shorter by T / EA; drawn in by s it is as much shorter on its side.
    const double L = 60, w = 4, d = 1.5, young = 0.4;
    const Beam beam({L, w, w}, {30, 2, 2});
    const HyperelasticBody body = beam.body();
    const Material material{.young = young, .poisson = 0.3, .density = 0};
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
    std::vector<Vec3> path;
    for (int k = 0; k <= 30; ++k) path.emplace_back(L * k / 30, w / 2, w / 2 + d);
    const double EI = young * std::pow(w, 4) / 12, EA = young * w * w;
    const double T = 0.06;
    const TendonPull pull{tendon(path, false), T, 0};
    const Eigen::VectorXd u = body.equilibrium({MaterialLaw::neo_hookean, material, {.tendons = {pull}}}, none).u;
    // The arc of the axis, as long as it is under the tension, from (0, 0) to its end; d as measured from the axis.
    const double length = L * (1 - T / EA), curvature = T * d / EI, angle = curvature * length;
    EXPECT_GT(angle, 0.6);
    const Vec3 tip = beam.tip(u) + Vec3(L, 0, 0);
    const Vec3 expected(std::sin(angle) / curvature, 0, (1 - std::cos(angle)) / curvature);
    // Small strain of 1 %; ends where the tension goes in take a width of the beam. Half a per cent is left.
    EXPECT_LT((tip - expected).norm(), 0.006 * expected.norm()) << tip.transpose() << " " << expected.transpose();

    // Drawn in by as much as the tension did, it is under that tension.
    const double drawn = body.tendon_state(u, pull, false).drawn_in;
    EXPECT_NEAR(drawn, L * T / EA + d * angle, 0.1 * drawn);  // and where it is fixed, at a point, the end gives way
    const TendonPull by_length{tendon(path, true), drawn, young};
    const BodySetting setting{MaterialLaw::neo_hookean, material, {.tendons = {by_length}}};
    const Eigen::VectorXd v = body.equilibrium(setting, none).u;
    EXPECT_LT(relative(v, u), 1e-3);  // the cable's own stretch
    EXPECT_NEAR(body.tendon_state(v, by_length, false).tension, T, 1e-3 * T);
}

TEST(Tendon, ACableDoesNotPush) {
    const Actuated bar;
    const TendonPull slack{tendon(bar.path, true), -0.1, 0.3};
    const BodySetting setting{MaterialLaw::neo_hookean, bar.material, {.tendons = {slack}}};
    EXPECT_EQ(bar.body.equilibrium(setting, bar.none()).u, bar.none());
    EXPECT_EQ(bar.body.tendon_state(bar.none(), slack, false).tension, 0);
}

TEST(Rig, WorkRoundALoopIsNone) {
    // What a grip, a tendon by length and a cavity's pressure do on the way there is stored, and comes back: the works
    // add up to zero over a loop, and over half of it to what the energy grew by. Sums over a smooth loop of n steps
    // are exact to exp(-n), as long as the cable stays taut.
    Actuated bar;
    const auto grip = grip_tool(9, Vec3(9.5, 1.5, 1.5));
    const auto place = cavity(Vec3(3, 1.5, 1.5));
    const auto cable = tendon({{0, 0.4, 2.6}, {3.1, 0.5, 2.5}, {6.3, 0.4, 2.4}}, true);
    const auto at = [&](double phase) {
        const double c = std::cos(phase), s = std::sin(phase);
        return BodySetting{MaterialLaw::neo_hookean,
                           bar.material,
                           {.tools = {moved(grip, Vec3(0.2 * s, 0.3 * c, 0.3 * s), Vec3(0.1 * c, 0, 0), 0.3)},
                            .cavities = {{place, 0.01 + 0.005 * s}},
                            .tendons = {{cable, 0.3 + 0.03 * c, 0.3}}}};
    };
    constexpr int n = 16;
    double work = 0, effort = 0;
    Eigen::VectorXd u = bar.none();
    for (int k = 0; k < n; ++k) {
        const double phase = 2 * std::numbers::pi * k / n, h = 2 * std::numbers::pi / n;
        const double c = std::cos(phase), s = std::sin(phase);
        const BodySetting setting = at(phase);
        u = bar.body.equilibrium(setting, bar.none(), {.tolerance = 1e-10}, &u).u;
        const Wrench wrench = bar.body.wrench(u, setting.effects.tools[0]);
        // Of the tool's motion, the length drawn in, and of the pressure -(V - V0) dp, which is the work but for d(p
        // V).
        const double volume = bar.body.cavity_volumes(u)[bar.body.find_cavity(*place)] - 2;
        const double power[] = {wrench.dot((Wrench() << 0.2 * c, -0.3 * s, 0.3 * c, -0.1 * s, 0, 0).finished()),
                                bar.body.tendon_state(u, setting.effects.tendons[0], false).tension * -0.03 * s,
                                -volume * 0.005 * c};
        for (const double part : power) {
            work += h * part;
            effort += h * std::abs(part);
        }
    }
    EXPECT_GT(effort, 0.005);  // [N mm]
    EXPECT_LT(std::abs(work), 1e-6 * effort);
}

TEST(Actuators, MessagesSayWhatToDo) {
    const Beam beam({6, 2, 2}, {4, 2, 2});
    const HyperelasticBody body = beam.body();
    const auto with = [&](const Effects& effects) {
        return [&body, &beam, effects] {
            body.equilibrium({MaterialLaw::linear, {}, effects}, Eigen::VectorXd::Zero(beam.mesh.nodes.size()));
        };
    };
    EXPECT_THAT(with({.cavities = {{cavity(Vec3::Zero()), 0.1}}}),
                testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("encloses none"), HasSubstr("Close"))));
    EXPECT_THAT(with({.tendons = {{tendon({{0, 1, 1}, {3, 1, 4}}, false), 1, 0}}}),
                testing::ThrowsMessage<InvalidInput>(
                    AllOf(HasSubstr("Point 2"), HasSubstr("2 mm outside"), HasSubstr("(3, 1, 2)"))));
    EXPECT_THAT(with({.tendons = {{tendon({{0, 1, 1}}, false), 1, 0}}}),
                testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("1 points"), HasSubstr("2 and more"))));
    EXPECT_THAT(with({.tendons = {{tendon({{0, 1, 1}, {3, 1, 1}, {3, 1, 1}}, false), 1, 0}}}),
                testing::ThrowsMessage<InvalidInput>(AllOf(HasSubstr("Points 2 and 3"), HasSubstr("take one"))));
}

}  // namespace
}  // namespace palpate::fem
