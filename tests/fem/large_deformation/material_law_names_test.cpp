#include "fem/large_deformation/material_law_names.h"

#include <gtest/gtest.h>

namespace palpate::fem {
namespace {

TEST(MaterialLawNames, EachLawIsFoundByItsNumberAndByItsName) {
    for (std::size_t i = 0; i < material_law_names.size(); ++i) {
        const MaterialLaw law = material_law_names[i].law;
        EXPECT_EQ(static_cast<std::size_t>(law), i);
        EXPECT_EQ(material_law(name_in_files(law)), law);
        EXPECT_EQ(material_law_choices()[i], name_in_files(law));
    }
    EXPECT_FALSE(material_law("neo-Hookean"));  // the name in prose is none in files
}

}  // namespace
}  // namespace palpate::fem
