#include "pipeline/output/html/page_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/output/html/escape.h"

namespace palpate::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(PageFrame, HeadNeedsNoOtherFile) {
    const std::string head = page_head("Liver", "body { margin: 0 }");
    EXPECT_THAT(head, StartsWith("<!doctype html>\n<html lang=\"en\"><head>"));
    EXPECT_THAT(head, HasSubstr("<style>body { margin: 0 }</style></head>"));
    EXPECT_THAT(head, HasSubstr("href=\"data:,\""));  // the icon: a browser asks for none
}

TEST(PageFrame, TitleIsEscapedAndStyleIsNot) {
    const std::string head = page_head("E < 1 & \"soft\"", "main > h1 {}");
    EXPECT_THAT(head, HasSubstr("<title>E &lt; 1 &amp; &quot;soft&quot;</title>"));
    EXPECT_THAT(head, HasSubstr("main > h1 {}"));
}

TEST(Prose, KeepsANumberWithItsUnitOnOneLine) {
    EXPECT_EQ(prose("ν = 0.43 ± 0.12, 3 mm of (1, 2) mm/s^2, 95 % < 3 modes"),
              "ν\u00a0=\u00a00.43 ±\u00a00.12, 3\u00a0mm of (1, 2)\u00a0mm/s², 95\u00a0% &lt; 3 modes");
}

TEST(PageFrame, SectionLinksFollowHeadingsThatHaveAnId) {
    EXPECT_EQ(section_links("<h2 id=\"b\">Second</h2><p>text</p><h2>No link</h2><h2 id=\"a\">First &amp; last</h2>"),
              "<nav aria-label=\"Sections\"><a href=\"#b\">Second</a><a href=\"#a\">First &amp; last</a></nav>");
    EXPECT_EQ(section_links("<p>nothing</p>"), "<nav aria-label=\"Sections\"></nav>");
}

}  // namespace
}  // namespace palpate::pipeline
