#include "skeleton/links/full_link.h"

#include <gtest/gtest.h>

#include "skeleton/statics/equilibrium.h"
#include "tests/skeleton/links/link_ends.h"

namespace palpate::skeleton {
namespace {

using testing::random_vector;

struct FullEnds : testing::LinkEnds {
    LinkSection section;
    double length = 12;
    Vec3 X_a = Vec3(3, -2, 5), X_b = Vec3(11, 2, -3);

    FullEnds() {
        x_a = X_a;
        x_b = X_b;
        const Vec3 along = (X_b - X_a).normalized(), across = along.unitOrthogonal();
        section.at = 0.6 * X_a + 0.4 * X_b + 1.5 * across;
        section.axes << along.transpose(), across.transpose(), along.cross(across).transpose();
    }
    FullLink link() const { return {section, length, X_a, X_b, x_a, R_a, x_b, R_b}; }
    LinkTerms terms() const { return full_link_terms(link(), true); }
    FullEnds moved(const Vec12& step) const {
        FullEnds next = *this;
        next.step(step);
        return next;
    }
};

FullEnds random_full_ends(std::mt19937_64& engine) {
    FullEnds ends;
    ends.strain(ends.X_b - ends.X_a, engine);
    return ends;
}

TEST(FullLink, RestCostsNothing) {
    EXPECT_LT(full_link_terms(FullEnds().link(), false).energy.norm(), 1e-28);
    EXPECT_LT(FullEnds().link().strains().norm(), 1e-14);
}

TEST(FullLink, RigidMotionChangesNothing) {
    std::mt19937_64 engine(1);
    for (int i = 0; i < 50; ++i) {
        const FullEnds ends = random_full_ends(engine);
        const Mat3 R = rotation(random_vector(engine, 3));
        const Vec3 shift = random_vector(engine, 50);
        FullEnds moved = ends;
        moved.move(R, shift);
        EXPECT_LT((moved.link().strains() - ends.link().strains()).norm(), 1e-12);
    }
}

TEST(FullLink, GradientIsTheEnergysDerivative) {
    std::mt19937_64 engine(2);
    const double h = 1e-5;
    for (int i = 0; i < 20; ++i) {
        const FullEnds ends = random_full_ends(engine);
        const LinkTerms terms = ends.terms();
        for (int c = 0; c < 12; ++c) {
            const Vec12 step = h * Vec12::Unit(c);
            const Stiffnesses numeric = (ends.moved(step).terms().energy - ends.moved(-step).terms().energy) / (2 * h);
            EXPECT_LT((terms.gradient.row(c).transpose() - numeric).norm(), 1e-7 * (1 + numeric.norm()));
        }
    }
}

TEST(FullLink, HessianIsTheSecondDerivative) {
    std::mt19937_64 engine(3);
    const double h = 1e-3;
    for (int i = 0; i < 10; ++i) {
        const FullEnds ends = random_full_ends(engine);
        const LinkTerms terms = ends.terms();
        Vec12 along;
        along << random_vector(engine, 1), random_vector(engine, 0.2), random_vector(engine, 1),
            random_vector(engine, 0.2);
        // along a straight line in exponential coordinates
        const auto energy = [&](double t) { return ends.moved(t * h * along).terms().energy; };
        const Stiffnesses numeric =
            (-energy(2) + 16 * energy(1) - 30 * energy(0) + 16 * energy(-1) - energy(-2)) / (12 * h * h);
        for (int s = 0; s < 6; ++s) {
            EXPECT_NEAR(along.dot(terms.hessian[s] * along), numeric[s], 1e-6 * (1 + std::abs(numeric[s]))) << s;
            EXPECT_LT((terms.hessian[s] - terms.hessian[s].transpose()).norm(), 1e-12 * terms.hessian[s].norm());
        }
    }
}

// A straight cantilever of full links, of Young's modulus E and section b x h.
struct Beam {
    double E = 2, mu = 0.8, b = 3, h = 5, L = 60;
    double area = b * h, I_1 = b * h * h * h / 12, I_2 = h * b * b * b / 12;

    Model model(int links) const {
        Model model = testing::make_chain(links);
        const double l = L / links;
        for (int i = 0; i <= links; ++i) model.spheres[i].center = Vec3(i * l, 0, 0);
        for (Link& link : model.links) {
            link.length = l;
            link.section = LinkSection{(link.a + 0.5) * l * Vec3::UnitX(), Mat3::Identity(), area};
            link.stiffness.resize(6);
            const double shear = l / (5.0 / 6 * mu * area), bending = l * l * l / (12 * E);
            link.stiffness << E * area / l, E * I_1 / l, 1, E * I_2 / l, 1 / (shear + bending / I_1),
                1 / (shear + bending / I_2);
        }
        return model;
    }
};

TEST(FullLink, ChainBendsAsTimoshenkosBeamHoweverManyLinks) {
    const Beam beam;
    for (const int links : {1, 2, 7}) {
        Model model = beam.model(links);
        model.law = EquilibriumLaw::linear;
        const Vec3 force(0, 0.01, 0.02);
        const Equilibrium found = equilibrium(model, testing::force_at(model, links, force));
        const Eigen::VectorXd tip = found.step.segment<3>(6 * links);
        const auto deflection = [&](double I) {
            return beam.L * beam.L * beam.L / (3 * beam.E * I) + beam.L / (5.0 / 6 * beam.mu * beam.area);
        };
        EXPECT_NEAR(tip[1], force.y() * deflection(beam.I_1), 1e-9) << links;
        EXPECT_NEAR(tip[2], force.z() * deflection(beam.I_2), 1e-9) << links;
    }
}

}  // namespace
}  // namespace palpate::skeleton
