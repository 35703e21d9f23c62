// `regions` of a set.yaml: what is read, what is refused, what is written.

#include <gtest/gtest.h>

#include "tests/identify/measurement_set_files.h"

namespace palpate::identify {
namespace {

struct RegionFiles : MeasurementSetFiles {
    RegionFiles() {
        mesh::write_surface(folder / "ball.stl", mesh::make_sphere({60, 10, 10}, 6, 2));
        mesh::write_surface(folder / "core.stl", mesh::make_sphere({60, 10, 10}, 3, 2));
        mesh::write_surface(folder / "root.stl", mesh::make_sphere({5, 10, 10}, 3, 2));
    }
    static std::string second(std::string yaml) {
        yaml.replace(yaml.find("measurements/1"), 14, "measurements/2");
        return yaml;
    }
    std::string refusal_of(const std::string& item) {
        return refusal("set.yaml", second(yaml) + "regions:\n  - {" + item + "}\n");
    }
};

TEST_F(RegionFiles, AreReadInMillimetresAndAsKnownOrUnknown) {
    folder.write("set.yaml", second(yaml) +
                                 "regions:\n"
                                 "  - {name: ball, surface: ball.stl, young: null, poisson: 0.49, density: 1050}\n"
                                 "  - {name: core, surface: core.stl, young: 2.5}\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.regions.size(), 2U);
    EXPECT_EQ(set.regions[0].name, "ball");
    EXPECT_FALSE(set.regions[0].young);
    EXPECT_EQ(set.regions[0].poisson.value(), 0.49);
    EXPECT_NEAR(set.regions[0].density.value(), 1.05e-9, 1e-20);
    EXPECT_EQ(set.regions[1].young.value(), 2.5);
    EXPECT_FALSE(set.regions[1].poisson);
    EXPECT_FALSE(set.regions[1].density);
    EXPECT_NEAR(mesh::bounding_box(set.regions[0].surface.vertices).max.x(), 66, 0.1);
    EXPECT_TRUE(needs_second_format(set));
}

TEST_F(RegionFiles, AreToldByLabelsOfTheRestMesh) {
    // The outer half by its label, which touches the body's surface and the rest.
    const mesh::VolumeMesh bar = mesh::make_bar({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    Eigen::MatrixXd label(bar.tetrahedra.rows(), 1);
    for (Eigen::Index e = 0; e < label.rows(); ++e) label(e) = bar.nodes(bar.tetrahedra.row(e), 0).mean() < 50 ? 1 : 2;
    mesh::write_vtu(folder / "rest.vtu", bar, {.points = {}, .cells = {{"material", label}}});
    std::string text = second(yaml);
    text.replace(text.find("rest.vtp"), 8, "rest.vtu");
    folder.write("set.yaml", text + "regions:\n  - {name: tip, label: 2, young: null}\n");
    const MeasurementSet set = read();
    ASSERT_EQ(set.regions.size(), 1U);
    EXPECT_EQ(set.regions[0].label, 2);
    EXPECT_NEAR(mesh::signed_volume(set.regions[0].surface), 20000, 1e-6);
    // A set that is written tells it by its surface.
    write_measurement_set(folder / "copy", set);
    const MeasurementSet copy = read_measurement_set(folder / "copy");
    ASSERT_EQ(copy.regions.size(), 1U);
    EXPECT_NEAR(mesh::signed_volume(copy.regions[0].surface), 20000, 1e-6);
}

TEST_F(RegionFiles, AreWrittenAsTheyAreRead) {
    folder.write("set.yaml", second(yaml) +
                                 "regions:\n"
                                 "  - {name: \"a: b\", surface: ball.stl, young: null, poisson: 0.49, density: 1050}\n"
                                 "  - {name: core, surface: core.stl, young: 2.5}\n");
    const MeasurementSet set = read();
    write_measurement_set(folder / "copy", set);
    const MeasurementSet copy = read_measurement_set(folder / "copy");
    ASSERT_EQ(copy.regions.size(), 2U);
    for (std::size_t r = 0; r < 2; ++r) {
        EXPECT_EQ(copy.regions[r].name, set.regions[r].name);
        EXPECT_EQ(copy.regions[r].young, set.regions[r].young);
        EXPECT_EQ(copy.regions[r].poisson, set.regions[r].poisson);
        EXPECT_EQ(copy.regions[r].surface.vertices, set.regions[r].surface.vertices);
    }
    EXPECT_DOUBLE_EQ(copy.regions[0].density.value(), set.regions[0].density.value());
}

TEST_F(RegionFiles, ThatAreNoneAreRefused) {
    EXPECT_TRUE(says(refusal_of("surface: ball.stl, young: 1"), {"set.yaml, line 8", "name"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl"), {"'a'", "no material", "young: null"}));
    EXPECT_TRUE(says(refusal_of("name: a, young: 1"), {"'a'", "neither 'surface' nor 'label'", "closed surface"}));
    EXPECT_TRUE(says(refusal_of("name: a, label: 2, surface: ball.stl, young: 1"), {"'a'", "both"}));
    EXPECT_TRUE(says(refusal_of("name: a, label: 2, young: 1"), {"rest.vtp", "no labels", "'surface'"}));
    EXPECT_TRUE(says(refusal("set.yaml", second(yaml) + "regions:\n  - {name: a, label: 2, young: 1}\n"
                                                        "  - {name: b, label: 2, young: null}\n"),
                     {"line 9", "label 2 is that of region 'a'"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl, young: -1"), {"young", "-1"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl, young: stiff"), {"young", "stiff"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl, young: 1, poisson: 0.5"), {"poisson", "0.5"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl, young: 1, density: 1e-9"), {"density", "1e-09"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ../ball.stl, young: 1"), {"surface", "out of the set's folder"}));
    EXPECT_TRUE(says(refusal_of("name: a, surface: ball.stl, young: 1, law: svk"), {"law"}));
    EXPECT_TRUE(says(refusal("set.yaml", second(yaml) + "regions:\n  - {name: a, surface: ball.stl, young: 1}\n"
                                                        "  - {name: a, surface: core.stl, young: 1}\n"),
                     {"'a'", "another one"}));
    mesh::Surface open = mesh::make_sphere({60, 10, 10}, 6, 2);
    open.triangles.conservativeResize(open.triangles.rows() - 1, 3);
    mesh::write_surface(folder / "open.stl", open);
    EXPECT_TRUE(says(refusal_of("name: a, surface: open.stl, young: 1"), {"open.stl", "3 open edges", "region 'a'"}));
}

TEST_F(RegionFiles, ThatAreHeldAltogetherAreKnownOrRefused) {
    std::string held = second(yaml);
    held.replace(held.find("0.1, 21, 21"), 11, "9, 21, 21  ");
    const std::string region = "regions:\n  - {name: root, surface: root.stl, young: ";
    EXPECT_TRUE(says(refusal("set.yaml", held + region + "null}\n"), {"'root'", "supports", "Give its 'young'"}));
    EXPECT_EQ(refusal("set.yaml", held + region + "3}\n"), "");
}

TEST_F(RegionFiles, ThatContradictTheBodyAreRefusedByTheirPlace) {
    mesh::write_surface(folder / "out.stl", mesh::make_sphere({60, 10, 16}, 6, 2));
    EXPECT_TRUE(
        says(refusal_of("name: a, surface: out.stl, young: 1"), {"set.yaml", "'a'", "reaches 2 mm out of the body"}));
}

}  // namespace
}  // namespace palpate::identify
