// A plane that a body leans on: what it bears, and that it does not pull.

#include "fem/effects/point/contact.h"

#include "beam.h"
#include "point_potentials.h"

namespace palpate::fem {
namespace {

TEST(ContactPlane, TermsAreDerivativesAndOneSided) {
    const ContactPlane plane(Vec3(0, 3, 4), 2.0, 0.7);
    const auto at = [&](const Eigen::VectorXd& x) { return plane.terms(Vec3::Zero(), x); };
    const Vec3 within(0.3, 1, 1), beyond(0.3, 2, 2);
    const auto energy = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(1, at(x).energy).eval(); };
    const auto gradient = [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(at(x).gradient); };
    // A parabola's central differences are exact but for rounding, 1e-16 over the step.
    EXPECT_LT((differences(energy, within, 1e-4).transpose() - at(within).gradient).norm(), 1e-11);
    EXPECT_LT((differences(gradient, within, 1e-4) - at(within).hessian).norm(), 1e-11);
    EXPECT_NEAR(at(within).gradient.norm(), 0.7 * (2 - 1.4), 1e-15);
    EXPECT_EQ(at(beyond).energy, 0);
    EXPECT_EQ(at(beyond).gradient, Vec3::Zero());
    EXPECT_EQ(at(beyond).hessian, Mat3::Zero());
}

/// A block on weak springs [N/mm], 0.1 mm above a plane at z = -0.1.
struct Block {
    static constexpr double springs = 1e-3, k = 2.0;  // [N/mm], [N/mm^3]
    Beam beam{{4, 4, 2}, {4, 4, 2}};
    HyperelasticBody body = beam.body();
    Eigen::VectorXd down = -on_top();
    std::shared_ptr<const ContactPlane> plane = std::make_shared<ContactPlane>(Vec3(0, 0, 1), -0.1, k);

    BodySetting setting(MaterialLaw law) const {
        return {law,
                {.young = 0.5, .poisson = 0.4, .density = 0},
                {.points = {std::make_shared<Springs>(ActsOn::support, springs, 0.0), plane}}};
    }
    /// Forces of 1 N in all on the top, upwards.
    Eigen::VectorXd on_top() const {
        Eigen::VectorXd f = Eigen::VectorXd::Zero(beam.mesh.nodes.size());
        for (Eigen::Index face = 0; face < beam.mesh.faces.rows(); ++face) {
            const Points at = beam.mesh.nodes(beam.mesh.faces.row(face), Eigen::all);
            if (at.col(2).minCoeff() < 2 - 1e-9) continue;
            for (int m = 3; m < 6; ++m) f(3 * beam.mesh.faces(face, m) + 2) += 1.0 / (3 * 32);  // on 32 triangles
        }
        return f;
    }
    /// The plane's force, by the effect itself.
    Vec3 force(const Eigen::VectorXd& u) const {
        Vec3 sum = Vec3::Zero();
        const NodeWeights skin = body.points(ActsOn::surface, 0);
        for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
            const Vec3 X = beam.mesh.nodes.row(skin.nodes[i]), x = X + u.segment<3>(3 * skin.nodes[i]);
            sum -= skin.weights(static_cast<Eigen::Index>(i)) * plane->terms(X, x).gradient;
        }
        return sum;
    }
};

TEST(ContactPlane, PlaneBearsWhatPressesOnIt) {
    const Block block;
    for (const MaterialLaw law : laws) {
        const Eigen::VectorXd u = block.body.equilibrium(block.setting(law), 0.5 * block.down).u;
        // The springs take what they are pressed by 0.1 mm or so: 1e-4 N. There is no friction.
        EXPECT_LT((block.force(u) - Vec3(0, 0, 0.5)).norm(), 2e-4);
        // The face sinks in by pressure over stiffness, in the mean; edges and middle differ by as much again.
        const double expected = -0.1 - 0.5 / (16 * Block::k);
        EXPECT_NEAR(u.reshaped(3, u.size() / 3).row(2).maxCoeff(), expected, 0.5 / (16 * Block::k));
    }
}

TEST(ContactPlane, PlaneDoesNotPull) {
    const Block block;
    for (const MaterialLaw law : laws) {
        BodySetting without = block.setting(law);
        without.effects.points.pop_back();
        // Lifted, the block hangs on its springs as if there were no plane.
        const Eigen::VectorXd lift = 1e-5 * block.on_top();
        const Eigen::VectorXd u = block.body.equilibrium(block.setting(law), lift).u;
        EXPECT_EQ(block.force(u), Vec3::Zero());
        EXPECT_LT(relative(u, block.body.equilibrium(without, lift).u), 1e-6);  // Newton's tolerance
        // And pressed by less than bridges the gap, too.
        const Eigen::VectorXd little = block.body.equilibrium(block.setting(law), 1e-6 * block.down).u;
        EXPECT_EQ(block.force(little), Vec3::Zero());
    }
}

TEST(ContactPlane, BentBeamComesToRestOnIt) {
    // However stiff the plane, it is found, and from there a neighbouring load takes few steps.
    const Beam beam({20, 3, 3}, {10, 2, 2});
    const HyperelasticBody body = beam.body();
    const Eigen::VectorXd f = beam.end_force({0, 0, -0.003});
    for (const MaterialLaw law : laws) {
        for (const double k : {0.1, 10.0}) {
            const BodySetting setting{law,
                                      {.young = 0.1, .poisson = 0.4, .density = 0},
                                      {.points = {std::make_shared<ContactPlane>(Vec3(0, 0, 1), -1.5, k)}}};
            const BodyEquilibrium found = body.equilibrium(setting, f);
            EXPECT_NEAR(beam.tip(found.u).z(), -1.5, 0.06);  // free, it would come down by more than 8 mm
            EXPECT_LT(body.equilibrium(setting, 1.03 * f, {}, &found.u).factorisations, 5);
        }
    }
}

}  // namespace
}  // namespace palpate::fem
