#include "pipeline/command_line/terminal/printed_units.h"

#include <gtest/gtest.h>

#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {
namespace {

TEST(PrintedUnits, HavePowersAndProductsAsTheyArePrinted) {
    EXPECT_EQ(with_printed_units("9.8 m/s^2, 3 mm^3 and 2 N*mm/rad"), "9.8 m/s², 3 mm³ and 2 N·mm/rad");
    EXPECT_EQ(with_printed_units("chi^2"), "chi²");
}

TEST(PrintedUnits, LeaveOtherTextAlone) {
    for (const char* text : {"", "2^3", "x^21", "10^-4", "a * b", "*", "^2", "N*", "samples/*.csv"})
        EXPECT_EQ(with_printed_units(text), text);
}

TEST(PrintedUnits, StandInPagesAndNotInWhatProgramsRead) {
    EXPECT_EQ(escape("5 mm^2 < 6"), "5 mm² &lt; 6");
    EXPECT_EQ(as_script_data({{"unit", "N*mm"}}), R"({"unit":"N*mm"})");
}

}  // namespace
}  // namespace palpate::pipeline
