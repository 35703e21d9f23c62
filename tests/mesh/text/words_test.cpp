#include "mesh/text/words.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::mesh {
namespace {

TEST(WithSd, GivesAsManyDigitsAsItBears) {
    EXPECT_EQ(with_sd(9.1997, 0.46), "9.2 ± 0.5");
    EXPECT_EQ(with_sd(0.24173, 0.0123), "0.242 ± 0.012");
    EXPECT_EQ(with_sd(-6.5574, 0.189), "-6.56 ± 0.19");
    EXPECT_EQ(with_sd(4714.4, 4242.4), "5000 ± 4000");
    EXPECT_EQ(with_sd(-9199.68, 127.1), "-9200 ± 130");
    EXPECT_EQ(with_sd(0.97, 0.0996), "0.97 ± 0.10");
    EXPECT_EQ(with_sd(-0.0001, 0.2), "0.00 ± 0.20") << "no minus before nothing";
}

TEST(WithSd, AWidthOfNothingIsNotTold) {
    EXPECT_EQ(with_sd(0.499, 0), "0.499");
    EXPECT_EQ(with_sd(1.23456, NAN), "1.23");
}

TEST(CountOf, OneIsOne) {
    EXPECT_EQ(count_of(1, "equilibrium", "equilibria"), "1 equilibrium");
    EXPECT_EQ(count_of(2, "equilibrium", "equilibria"), "2 equilibria");
    EXPECT_EQ(count_of(0, "probe"), "0 probes");
}

}  // namespace
}  // namespace palpate::mesh
