#include "mesh/text/csv_table.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

struct Csv : ::testing::Test {
    CsvTable table(const std::string& text) { return {folder.write("table.csv", text), {"a", "b"}, {"c"}}; }
    std::string refusal(const std::string& text) {
        return message_of<InvalidInput>([&] { table(text); });
    }
    TemporaryFolder folder;
};

TEST_F(Csv, ReadsWhatSpreadsheetsWrite) {
    const CsvTable read = table(
        "\xEF\xBB\xBF# a comment\r\n"
        "\r\n"
        " b , a,\"c\"\r\n"
        "1,+2.5e-1,\"-3\"   # another\r\n"
        "  # alone\r\n"
        "4,5,\r\n"
        "6,-0.5,.5");
    ASSERT_EQ(read.rows(), 3);
    EXPECT_EQ(read.at(0, "a"), 0.25);
    EXPECT_EQ(read.at(0, "b"), 1);
    EXPECT_EQ(read.at(0, "c"), -3);
    EXPECT_TRUE(std::isnan(read.at(1, "c")));
    EXPECT_EQ(read.at(2, "c"), 0.5);
    EXPECT_EQ(read.integer(1, "b"), 4);
    EXPECT_EQ(read.where(1), "table.csv, line 6");
}

TEST_F(Csv, ReadsSemicolonsWithDecimalCommas) {
    const CsvTable read = table(
        "\xEF\xBB\xBF"
        "A;b;C\r\n1,5;-2;0,25\r\n2.5;1e3;\r\n;;\r\n");
    ASSERT_EQ(read.rows(), 2) << "a row of empty cells is none";
    EXPECT_EQ(read.at(0, "a"), 1.5);
    EXPECT_EQ(read.at(0, "b"), -2);
    EXPECT_EQ(read.at(0, "c"), 0.25);
    EXPECT_EQ(read.at(1, "a"), 2.5);
    EXPECT_EQ(read.at(1, "b"), 1000);
    EXPECT_TRUE(std::isnan(read.at(1, "c")));
    EXPECT_EQ(table("a\tb\n1,5\t2\n").at(0, "a"), 1.5);
    EXPECT_TRUE(says(refusal("a;b\n1.234,5;2\n"), {"line 2", "1.234,5", "no number"}));
}

TEST_F(Csv, WhatWasNotMeasuredMayBeWritten) {
    const CsvTable read = table("a,b,c\nnan,NA,n/a\n1,NaN,\n");
    ASSERT_EQ(read.rows(), 2);
    for (const char* column : {"a", "b", "c"}) EXPECT_TRUE(std::isnan(read.at(0, column)));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.number(1, "b"); }), {"line 3", "column b", "empty"}));
}

TEST_F(Csv, AHeaderMayTellUnits) {
    const CsvTable read = table("A [mm], b (N) ,c\n1,2,3\n");
    EXPECT_EQ(read.at(0, "a"), 1);
    read.require_unit({"a", "c"}, "mm", "set.yaml");
    read.require_unit({"b"}, "N", "set.yaml");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.require_unit({"a"}, "m", "set.yaml"); }),
                     {"table.csv, column a", "[mm]", "set.yaml says m"}));
}

TEST_F(Csv, AnOptionalColumnMayBeAbsent) {
    const CsvTable read = table("a,b\n1,2\n");
    EXPECT_TRUE(read.has("a"));
    EXPECT_FALSE(read.has("c"));
    EXPECT_TRUE(std::isnan(read.at(0, "c")));
}

TEST_F(Csv, ReadsNamesWhereTheyStand) {
    const CsvTable read(folder.write("named.csv", "who,a\n left chamber ,1\n\"b, c\",2\n7,\n,3\n"), {"who", "a"}, {},
                        {"who"});
    EXPECT_EQ(read.name(0, "who"), "left chamber");
    EXPECT_EQ(read.name(1, "who"), "b, c");
    EXPECT_EQ(read.name(2, "who"), "7");
    EXPECT_EQ(read.number(1, "a"), 2);
    EXPECT_TRUE(std::isnan(read.at(2, "a")));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.name(3, "who"); }),
                     {"named.csv, line 5", "column who", "A name is needed"}));
}

TEST_F(Csv, ReadsTheSameInEveryLocale) {
    // Where the machine has no German locale the C locale stays, and the test is an easy one.
    const std::string before = std::setlocale(LC_ALL, nullptr);
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    const double value = table("a,b\n1.5,2\n").at(0, "a");
    std::setlocale(LC_ALL, before.c_str());
    EXPECT_EQ(value, 1.5);
}

TEST_F(Csv, RefusesWhatIsNoNumber) {
    for (const char* word : {"inf", "-inf", "1e999", "0x10", "1.5mm", "1 2", "--1", "+-1", "1e", "''"})
        EXPECT_TRUE(says(refusal("a,b\n1,2\n3," + std::string(word) + "\n"),
                         {"table.csv, line 3", "column b", word, "no number"}));
    EXPECT_TRUE(says(refusal("a,b\n1,\"2,5\"\n"), {"line 2", "'2,5'"}));
}

TEST_F(Csv, RefusesWhatIsNoUtf8) {
    EXPECT_TRUE(says(refusal("a,b\n1,2 # \xB5m\n"), {"table.csv, line 2", "0xB5", "UTF-8"}));
}

TEST_F(Csv, RefusesRowsOfAnotherLength) {
    EXPECT_TRUE(says(refusal("a,b\n1,2\n\n3\n"), {"line 4", "1 cells", "2", "a,b"}));
    EXPECT_TRUE(says(refusal("a,b\n1,2,3\n"), {"line 2", "3 cells"}));
}

TEST_F(Csv, RefusesColumnsThatItDoesNotKnow) {
    EXPECT_TRUE(says(refusal("a,b,d\n"), {"line 1", "unknown column 'd'", "a,b", "optional: c"}));
    EXPECT_TRUE(says(refusal("1,2\n3,4\n"), {"line 1", "unknown column '1'", "header"}));
    EXPECT_TRUE(says(refusal("a,c\n"), {"'b' is missing"}));
    EXPECT_TRUE(says(refusal("a,b,a\n"), {"'a' is named twice"}));
    EXPECT_TRUE(says(refusal("a b\n1 2\n"), {"no comma, semicolon or tab", "by commas"}));
    EXPECT_TRUE(says(refusal("# only a comment\n"), {"empty", "a,b"}));
}

TEST_F(Csv, SuggestsTheColumnThatWasMeant) {
    const auto file = folder.write("probes.csv", "probe,tiem\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] {
                         CsvTable(file, {"probe", "time"});
                     }),
                     {"'tiem'", "did you mean 'time'"}));
}

TEST_F(Csv, AsksForNumbersWhereTheyAreNeeded) {
    const CsvTable read = table("a,b\n1,\n1.5,3000000000\n");
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.number(0, "b"); }), {"line 2", "column b", "empty"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.integer(1, "a"); }), {"line 3", "1.5", "whole number"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read.integer(1, "b"); }), {"line 3", "3000000000", "2147483647"}));
}

TEST_F(Csv, AMissingFileIsNamed) {
    EXPECT_TRUE(says(message_of<IoError>([&] { CsvTable(folder / "none.csv", {"a"}); }), {"none.csv", "no such file"}));
}

}  // namespace
}  // namespace palpate::mesh
