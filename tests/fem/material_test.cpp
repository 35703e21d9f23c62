#include "fem/material.h"

#include <limits>

#include "bodies.h"
#include "mesh/errors.h"
#include "tests/messages.h"

namespace palpate::fem {
namespace {

using testing::HasSubstr;

std::string complaint(const Material& material) {
    return message_of<InvalidInput>([&] { material.validate(); });
}

TEST(Material, LameConstantsGiveYoungAndPoissonBack) {
    const Material material{.young = 0.3, .poisson = 0.42};
    const double mu = material.shear_modulus(), lambda = material.lame_lambda();
    // Rounding only.
    EXPECT_NEAR(mu * (3 * lambda + 2 * mu) / (lambda + mu), material.young, 1e-15);
    EXPECT_NEAR(lambda / (2 * (lambda + mu)), material.poisson, 1e-15);
}

TEST(Material, ValuesInRangeAreTaken) {
    EXPECT_NO_THROW((Material{.young = 1e-4, .poisson = 0.4999, .density = 0}.validate()));
    EXPECT_NO_THROW((Material{.young = 2e5, .poisson = -0.9}.validate()));
}

TEST(Material, ComplaintsNameValueAndRange) {
    EXPECT_THAT(complaint({.young = 0}), HasSubstr("Young's modulus is 0 MPa; allowed: more than 0"));
    EXPECT_THAT(complaint({.young = std::numeric_limits<double>::quiet_NaN()}), HasSubstr("Young's modulus is nan"));
    EXPECT_THAT(complaint({.poisson = 0.5}), HasSubstr("Poisson's ratio is 0.5; allowed: more than -1, less than 0.5"));
    EXPECT_THAT(complaint({.poisson = -1}), HasSubstr("Poisson's ratio is -1"));
    EXPECT_THAT(complaint({.density = 1000}), HasSubstr("Density is 1000 tonne/mm^3"));
}

}  // namespace
}  // namespace palpate::fem
