#include "pipeline/analysis/mean_specimen.h"

#include <gmock/gmock.h>

namespace palpate::pipeline {
namespace {

using testing::HasSubstr;

/// Two spheres, a link and a box about them, of so many millimetres.
SpecimenModel specimen(const std::string& name, double size) {
    SpecimenModel result{name, {}};
    result.model.spheres.resize(2);
    result.model.spheres[1].center = {size, 0, 0};
    result.model.spheres[1].radius = size / 2;
    result.model.links.resize(1);
    result.model.links[0].b = 1;
    result.model.surface = mesh::make_box({0, 0, 0}, {size, size, size}, {1, 1, 1});
    result.model.effects = {{"gravity", {}}};
    return result;
}

TEST(MeanSpecimen, IsTheMeanOfPlacesThatCorrespond) {
    const MeanSpecimen mean = mean_specimen({specimen("a", 10), specimen("b", 20), specimen("c", 30)});
    ASSERT_TRUE(mean.model) << mean.why_none;
    EXPECT_NEAR(mean.model->spheres[1].center.x(), 20, 1e-12);
    EXPECT_NEAR(mean.model->spheres[1].radius, 10, 1e-12);
    EXPECT_NEAR(mean.model->surface.vertices.maxCoeff(), 20, 1e-12);
    EXPECT_TRUE(mean.model->effects.empty());
}

TEST(MeanSpecimen, SaysWhatDoesNotCorrespond) {
    SpecimenModel fewer = specimen("fewer", 10), apart = specimen("apart", 10), finer = specimen("finer", 10),
                  turned = specimen("turned", 10);
    fewer.model.spheres.pop_back();
    apart.model.spheres.push_back({});
    apart.model.links[0].b = 2;
    SpecimenModel three = specimen("three", 10);
    three.model.spheres.push_back({});
    finer.model.surface = mesh::make_box({0, 0, 0}, {10, 10, 10}, {2, 2, 2});
    std::swap(turned.model.surface.triangles(0, 0), turned.model.surface.triangles(0, 1));
    const SpecimenModel a = specimen("a", 10);
    EXPECT_THAT(mean_specimen({a, fewer}).why_none, HasSubstr("a has 2 spheres, fewer has 1"));
    EXPECT_THAT(mean_specimen({three, apart}).why_none, HasSubstr("join different spheres"));
    EXPECT_THAT(mean_specimen({a, finer}).why_none, HasSubstr("vertices"));
    EXPECT_THAT(mean_specimen({a, turned}).why_none, HasSubstr("join different vertices"));
    EXPECT_FALSE(mean_specimen({a, turned}).model);
}

}  // namespace
}  // namespace palpate::pipeline
