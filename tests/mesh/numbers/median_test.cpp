#include "mesh/numbers/median.h"

#include <gtest/gtest.h>

namespace palpate::mesh {
namespace {

TEST(UpperMedian, IsTheMiddleOfAnOddNumberAndTheUpperMiddleOfAnEvenOne) {
    EXPECT_EQ(upper_median(std::vector{7}), 7);
    EXPECT_EQ(upper_median(std::vector{5.0, 1.0, 3.0}), 3.0);
    EXPECT_EQ(upper_median(std::vector{4.0, 1.0, 3.0, 2.0}), 3.0);
}

}  // namespace
}  // namespace palpate::mesh
