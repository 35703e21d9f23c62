#include "fem/elements/dilatation.h"

#include "tests/fem/beam.h"

namespace palpate::fem {
namespace {

/// How far the end of a plate of 60 x 24 x 1.5 mm, held along an edge, bends under its share of a force; of `layers`
/// of elements that are twice as long as it is thick.
double deflection(int layers, double poisson, Dilatation dilatation) {
    const Beam plate({60, 24, 1.5}, {20, 8, layers});
    const Material material{.young = 1, .poisson = poisson, .density = 0};
    const Eigen::VectorXd f = plate.end_force({0, 0, -1e-6});
    return -plate.tip(plate.body(dilatation).equilibrium({MaterialLaw::linear, material, {}}, f).u).z();
}

TEST(ThinElements, OneInAPlatesThicknessBendsAsManyDo) {
    for (const double poisson : {0.33, 0.45, 0.49}) {
        const double many = deflection(3, poisson, Dilatation::thin);
        // As many as these do by the mean dilatation, whose error falls with the square of their height: 20 % / 9.
        EXPECT_NEAR(deflection(3, poisson, Dilatation::mean) / many, 1, 0.03) << poisson;
        EXPECT_NEAR(deflection(1, poisson, Dilatation::thin) / many, 1, 0.05) << poisson;
        EXPECT_GT(deflection(1, poisson, Dilatation::mean) / many, 1.1) << poisson;
    }
    // With all of the divergence they lock.
    EXPECT_LT(deflection(1, 0.499, Dilatation::full) / deflection(3, 0.499, Dilatation::thin), 0.95);
}

TEST(ThinElements, AreFullOnesUpToAPoissonsRatioOfFourTenths) {
    for (const double poisson : {0.0, 0.3, 0.4})
        EXPECT_NEAR(deflection(1, poisson, Dilatation::thin) / deflection(1, poisson, Dilatation::full), 1, 1e-9);
}

}  // namespace
}  // namespace palpate::fem
