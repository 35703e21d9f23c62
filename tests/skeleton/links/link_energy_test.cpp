#include "skeleton/links/link_energy.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/errors.h"
#include "tests/skeleton/links/link_ends.h"

namespace palpate::skeleton {
namespace {

using testing::random_vector;

struct Ends : testing::LinkEnds {
    double length = 12;
    Vec3 direction = Vec3::UnitX();

    LinkTerms terms(bool with_hessian = false) const {
        return link_terms(length, direction, x_a, R_a, x_b, R_b, with_hessian);
    }
    Ends moved(const Vec12& step) const {
        Ends next = *this;
        next.step(step);
        return next;
    }
};

Ends random_ends(std::mt19937_64& engine) {
    Ends ends;
    ends.direction = random_vector(engine, 1).normalized();
    ends.strain(ends.length * ends.direction, engine);
    return ends;
}

Ends at_rest() {
    Ends ends;
    ends.direction = Vec3(1, 2, -2) / 3;
    ends.x_b = ends.length * ends.direction;
    return ends;
}

constexpr int repeats = 50;

TEST(LinkEnergy, RestCostsNothing) {
    const LinkTerms terms = at_rest().terms();
    // Rounding of a length of 12 mm.
    EXPECT_LT(terms.energy.norm(), 1e-28);
    EXPECT_LT(terms.gradient.norm(), 1e-14);
}

TEST(LinkEnergy, RigidMotionChangesNothing) {
    std::mt19937_64 engine(1);
    for (int i = 0; i < repeats; ++i) {
        const Ends ends = random_ends(engine);
        const Mat3 R = rotation(random_vector(engine, 3));
        const Vec3 shift = random_vector(engine, 50);
        Ends moved = ends;
        moved.move(R, shift);
        // Rounding of coordinates of 100 mm in squares of some 10.
        EXPECT_LT((moved.terms().energy - ends.terms().energy).norm(), 1e-11);
    }
}

TEST(LinkEnergy, NetForceAndTorqueAreZero) {
    std::mt19937_64 engine(2);
    for (int i = 0; i < repeats; ++i) {
        const Ends ends = random_ends(engine);
        const LinkTerms terms = ends.terms();
        for (int s = 0; s < 3; ++s) {
            const Vec12 g = terms.gradient.col(s);
            const Vec3 torque =
                g.segment<3>(3) + g.segment<3>(9) + ends.x_a.cross(g.segment<3>(0)) + ends.x_b.cross(g.segment<3>(6));
            // Rounding of forces of some 10 on arms of 50 mm.
            EXPECT_LT((g.segment<3>(0) + g.segment<3>(6)).norm(), 1e-14);
            EXPECT_LT(torque.norm(), 1e-11);
        }
    }
}

TEST(LinkEnergy, GradientIsItsDerivative) {
    std::mt19937_64 engine(3);
    const double h = 1e-5;
    for (int i = 0; i < repeats; ++i) {
        const Ends ends = random_ends(engine);
        const LinkTerms terms = ends.terms();
        for (int j = 0; j < 12; ++j) {
            const Vec12 step = h * Vec12::Unit(j);
            const Vec3 difference = (ends.moved(step).terms().energy - ends.moved(-step).terms().energy) / (2 * h);
            // h^2 times third derivatives of order 10, and rounding of energies of 10 over h.
            EXPECT_LT((difference - terms.gradient.row(j).transpose()).norm(), 1e-8);
        }
    }
}

// Differences of the gradient tell the derivative in the turned frames, which differs from the one in exponential
// coordinates by half of [torque]: their symmetric parts agree.
TEST(LinkEnergy, HessianIsTheGradientsDerivative) {
    std::mt19937_64 engine(4);
    const double h = 1e-5;
    for (int i = 0; i < repeats; ++i) {
        const Ends ends = random_ends(engine);
        const LinkTerms terms = ends.terms(true);
        std::array<Mat12, 3> D;
        for (int j = 0; j < 12; ++j) {
            const Vec12 step = h * Vec12::Unit(j);
            const auto difference = (ends.moved(step).terms().gradient - ends.moved(-step).terms().gradient).eval();
            for (int s = 0; s < 3; ++s) D[s].col(j) = difference.col(s) / (2 * h);
        }
        for (int s = 0; s < 3; ++s) {
            EXPECT_LT((terms.hessian[s] - terms.hessian[s].transpose()).norm(), 1e-13);
            // As for the gradient; third and fourth derivatives reach 100 where flexion is strong.
            EXPECT_LT((terms.hessian[s] - 0.5 * (D[s] + D[s].transpose())).norm(), 2e-7) << stiffness_names[s];
        }
    }
}

TEST(LinkEnergy, HessianIsTheEnergysSecondDerivativeInExponentialCoordinates) {
    std::mt19937_64 engine(5);
    const double h = 1e-3;
    for (int i = 0; i < repeats; ++i) {
        const Ends ends = random_ends(engine);
        const LinkTerms terms = ends.terms(true);
        Vec12 variation;
        for (int j = 0; j < 12; ++j) variation[j] = random_vector(engine, 1).x();
        const Vec3 second =
            (ends.moved(h * variation).terms().energy - 2 * terms.energy + ends.moved(-h * variation).terms().energy) /
            (h * h);
        for (int s = 0; s < 3; ++s) {
            const double expected = variation.dot(terms.hessian[s] * variation);
            // h^2 / 12 times fourth derivatives of order 100, and rounding of energies of 10 over h^2.
            EXPECT_NEAR(second[s], expected, 1e-4 + 1e-6 * std::abs(expected));
        }
    }
}

TEST(LinkEnergy, DerivativesAreSmoothThroughRest) {
    // On both sides of where the curvature changes to its series, and at rest itself.
    for (const double angle : {0.0, 1e-9, 1e-5, 0.0199, 0.0201}) {
        Ends ends = at_rest();
        ends.R_a = rotation(angle * Vec3(2, -1, 0).normalized());
        const LinkTerms terms = ends.terms(true);
        EXPECT_NEAR(terms.energy[1], 0.5 * angle * angle, 1e-17);
        const double h = 1e-5;
        Mat12 D;
        for (int j = 0; j < 12; ++j) {
            const Vec12 step = h * Vec12::Unit(j);
            D.col(j) = (ends.moved(step).terms().gradient.col(1) - ends.moved(-step).terms().gradient.col(1)) / (2 * h);
        }
        // Rounding over h, and h^2.
        EXPECT_LT((terms.hessian[1] - 0.5 * (D + D.transpose())).norm(), 1e-9) << angle;
    }
}

TEST(LinkEnergy, WeightedHessianIsTheSum) {
    std::mt19937_64 engine(6);
    const Ends ends = random_ends(engine);
    const LinkTerms terms = ends.terms(true);
    const Vec3 k(2, 300, 50);
    const Mat12 sum = k[0] * terms.hessian[0] + k[1] * terms.hessian[1] + k[2] * terms.hessian[2];
    const Mat12 H = link_hessian(k, ends.length, ends.direction, ends.x_a, ends.R_a, ends.x_b, ends.R_b);
    EXPECT_LT((H - sum).norm(), 1e-13 * sum.norm());  // rounding
}

TEST(LinkEnergy, PullBendAndTwistAreTheirClosedForms) {
    Ends ends = at_rest();
    ends.x_b += 3 * ends.direction;
    ends.R_a = rotation(0.4 * ends.direction.cross(Vec3::UnitX()).normalized());
    ends.R_b = rotation(2.5 * ends.direction);
    const LinkTerms terms = ends.terms();
    EXPECT_NEAR(terms.energy[0], 4.5, 1e-13);
    EXPECT_NEAR(terms.energy[1], 0.08, 1e-14);
    ends.R_a.setIdentity();
    EXPECT_NEAR(ends.terms().energy[2], 0.5 * 2.5 * 2.5, 1e-13);
    EXPECT_NEAR(ends.terms().energy[1], 0, 1e-28);
}

TEST(LinkEnergy, TorqueOfTwistGrowsToHalfATurn) {
    Ends ends = at_rest();
    double last = 0;
    for (double angle = 0.1; angle < std::numbers::pi; angle += 0.1) {
        ends.R_b = rotation(angle * ends.direction);
        const double torque = ends.terms().gradient.col(2).segment<3>(9).dot(ends.direction);
        EXPECT_GT(torque, last);
        last = torque;
    }
}

TEST(LinkEnergy, ForcesStayFiniteWhereAnEndPointsBackwards) {
    Ends ends = at_rest();
    ends.R_b = rotation(std::numbers::pi * ends.direction.cross(Vec3::UnitX()).normalized());
    const LinkTerms terms = ends.terms(true);
    EXPECT_TRUE(terms.energy.allFinite() && terms.gradient.allFinite());
    EXPECT_NEAR(terms.energy[1], 0.5 * std::numbers::pi * std::numbers::pi, 1e-12);
    EXPECT_LT(terms.gradient.col(1).norm(), 2 * std::numbers::pi);
}

TEST(LinkEnergy, EndsThatCoincideAreRefused) {
    Ends ends = at_rest();
    ends.x_b = ends.x_a;
    try {
        ends.terms();
        FAIL();
    } catch (const SolverFailure& failure) {
        EXPECT_NE(std::string(failure.what()).find("rest length 12 mm came to lie on one another"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate::skeleton
