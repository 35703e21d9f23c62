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

TEST(IsBeforeByNumbers, CountsAsPeopleDo) {
    EXPECT_TRUE(is_before_by_numbers("scan_9.stl", "scan_10.stl"));
    EXPECT_FALSE(is_before_by_numbers("scan_10.stl", "scan_9.stl"));
    EXPECT_TRUE(is_before_by_numbers("scan_009.stl", "scan_10.stl"));
    EXPECT_TRUE(is_before_by_numbers("a2b10", "a10b2"));
    EXPECT_TRUE(is_before_by_numbers("scan", "scan_1"));
    EXPECT_TRUE(is_before_by_numbers("a01", "a1"));
    EXPECT_FALSE(is_before_by_numbers("a1", "a01"));
}

TEST(Capitalised, ChangesTheFirstLetterAlone) {
    EXPECT_EQ(capitalised("pressure of 3 kPa"), "Pressure of 3 kPa");
    EXPECT_EQ(capitalised("ν is told"), "ν is told") << "beyond ASCII nothing changes";
    EXPECT_EQ(capitalised(""), "");
}

}  // namespace
}  // namespace palpate::mesh
