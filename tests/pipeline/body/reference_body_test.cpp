#include "pipeline/body/reference_body.h"

#include <gtest/gtest.h>

namespace palpate::pipeline {
namespace {

TEST(DilatationFor, ElementsAreThinWhereOneIsAllThereIsInTheThickness) {
    const mesh::Surface plate = mesh::make_box({0, 0, 0}, {100, 60, 4}, {10, 6, 1});
    EXPECT_EQ(dilatation_for(plate, 10), fem::Dilatation::thin);
    EXPECT_EQ(dilatation_for(plate, 2), fem::Dilatation::mean);
    const mesh::Surface block = mesh::make_box({0, 0, 0}, {40, 40, 40}, {4, 4, 4});
    EXPECT_EQ(dilatation_for(block, 8), fem::Dilatation::mean);
}

}  // namespace
}  // namespace palpate::pipeline
