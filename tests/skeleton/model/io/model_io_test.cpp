#include "skeleton/model/io/model_io.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

using testing::make_lattice;

// A file name of this test alone, gone at its end.
class ModelFile : public ::testing::Test {
protected:
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() /
        ("palpate-model-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    const std::filesystem::path file = folder / "model.json";

    void SetUp() override { std::filesystem::create_directories(folder); }
    void TearDown() override { std::filesystem::remove_all(folder); }

    Model read(const std::string& text) const {
        mesh::write_text(file, text);
        return read_model(file);
    }
    // The message without the folder.
    std::string complaint(const std::string& text) const {
        try {
            read(text);
        } catch (const InvalidInput& error) {
            const std::string what = error.what();
            EXPECT_EQ(what.rfind(file.string() + ": ", 0), 0u) << what;
            return what.substr(std::min(what.size(), file.string().size() + 2));
        }
        return "nothing was thrown";
    }
};

// Two spheres and a link, with something replaced or put in.
std::string two_spheres(const std::string& spheres_extra = "", const std::string& link_extra = "",
                        const std::string& top_extra = "") {
    return R"({"format": "palpate-model/1", "spheres": [{"center": [3, 0, 0], "radius": 2, "mass": 1e-6)" +
           spheres_extra + R"(}, {"center": [0, 4, 0], "radius": 1, "mass": 2e-6}], "links": [{"a": 0, "b": 1,
    "elongation": 1.5, "flexion": 20, "torsion": 30)" +
           link_extra + "}]" + top_extra + "}";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
}

TEST_F(ModelFile, IsReadBackEqual) {
    Model model = make_lattice({3, 2, 2});
    model.name = "liver \"3\"";
    model.law = EquilibriumLaw::linear;
    model.spheres[1].inertia << 1.1, 0.1, 0.2, 0.1, 2.2, 0.3, 0.2, 0.3, 3.3;
    model.links[4].zone = 7;
    model.links[5].length *= 1.25;
    model.links[6].gyration = 4.0 / 3;
    model.effects = {
        {"gravity", {{"gz", -9810, "mm/s^2"}, {"gx", 1.0 / 3, "mm/s^2"}, {"gy", 0, ""}}},
        {"compliant-support", {{"stiffness", 2.5, "N/mm"}}},
        {"stiffening", {{"c2", 0.25, "1"}, {"c3", 0, ""}}},
        {"anisotropy", {{"k", -0.5, "1"}, {"nx", 0, "1"}, {"ny", 1, "1"}, {"nz", 1, "1"}}},
        {"inclusion", {{"cx", 1, "mm"}, {"cy", 2, "mm"}, {"cz", 3, "mm"}, {"radius", 4, "mm"}, {"ratio", 8, "1"}}},
        {"contact", {{"nx", 0, "1"}, {"ny", 0, "1"}, {"nz", 1, "1"}, {"offset", -1, "mm"}, {"stiffness", 2, "N/mm^3"}}},
        {"pressure", {{"pressure", -0.01, "MPa"}}},
        {"prestress",
         {{"sxx", 0.1, "1"}, {"syy", 0, "1"}, {"szz", 0, "1"}, {"sxy", 0, "1"}, {"syz", 0, "1"}, {"sxz", 0, "1"}}},
        {"viscosity", {{"creep", 0.7, "1"}, {"tau", 20, "s"}}},
        {"plasticity", {{"yield", 0.05, "1"}, {"hardening", 0, "1"}}},
        {"damage", {{"share", 0.5, "1"}, {"strain", 0.05, "1"}}},
        {"volume", {{"poisson", 0.3, "1"}}},
        {"torsion", {{"torsion", 0.5, "1"}}},
        {"shear", {{"shear", 0.5, "1"}}},
        {"outliers", {}},
        {"misalignment", {{"tx", 0.1, "mm"}, {"rz", 0.01, "rad"}}}};
    model.surface = mesh::make_sphere({10, 5, 5}, 1.0 / 3, 1);
    for (Eigen::Index i = 0; i < model.surface.vertices.rows(); ++i)
        model.skin.push_back(attach_to_links(model, model.surface.vertices.row(i).transpose()));
    Points points(2, 3);
    points << 1, 2, 3, 0.1, 0.2, 0.3;
    model.supports = {mesh::BoxRegion{{-1, -2, -3}, {1, 2, 3}}, mesh::SphereRegion{{1, 2, 3}, 4},
                      mesh::PlaneRegion{{0, 0, 1}, {0, 0, 2}, 0.5}, mesh::PointsRegion{points, 0.25}};
    model.provenance = {{"mesh", "liver.stl"}, {"identified", "no"}};
    model.damping = {.alpha = 0.5, .beta = 0.125};

    write_model(file, model);
    const Model read = read_model(file);
    const std::string first = mesh::read_text(file);
    write_model(file, read);
    EXPECT_EQ(mesh::read_text(file), first);

    EXPECT_EQ(read.name, model.name);
    EXPECT_EQ(read.law, model.law);
    ASSERT_EQ(read.spheres.size(), model.spheres.size());
    for (size_t i = 0; i < model.spheres.size(); ++i) {
        EXPECT_EQ(read.spheres[i].center, model.spheres[i].center);
        EXPECT_EQ(read.spheres[i].inertia, model.spheres[i].inertia);
        EXPECT_EQ(read.spheres[i].held, model.spheres[i].held);
    }
    EXPECT_EQ(stiffness_vector(read), stiffness_vector(model));
    EXPECT_EQ(read.links[4].zone, 7);
    EXPECT_EQ(read.links[5].length, model.links[5].length);
    EXPECT_EQ(read.links[5].gyration, 0);
    EXPECT_EQ(read.links[6].gyration, model.links[6].gyration);
    ASSERT_EQ(read.effects.size(), model.effects.size());
    for (size_t e = 0; e < model.effects.size(); ++e) {
        EXPECT_EQ(read.effects[e].name, model.effects[e].name);
        ASSERT_EQ(read.effects[e].parameters.size(), model.effects[e].parameters.size());
        for (size_t p = 0; p < model.effects[e].parameters.size(); ++p) {
            EXPECT_EQ(read.effects[e].parameters[p].name, model.effects[e].parameters[p].name);
            EXPECT_EQ(read.effects[e].parameters[p].value, model.effects[e].parameters[p].value);
            EXPECT_EQ(read.effects[e].parameters[p].unit, model.effects[e].parameters[p].unit);
        }
    }
    EXPECT_EQ(read.surface.vertices, model.surface.vertices);
    EXPECT_EQ(read.surface.triangles, model.surface.triangles);
    ASSERT_EQ(read.skin.size(), model.skin.size());
    EXPECT_EQ(read.skin[9].shares[0].sphere, model.skin[9].shares[0].sphere);
    EXPECT_NEAR(read.skin[9].shares[0].weight, model.skin[9].shares[0].weight, 1e-8);
    EXPECT_LT((read.skin[9].shares[0].follow - model.skin[9].shares[0].follow).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_EQ(read.supports.size(), 4u);
    EXPECT_EQ(std::get<mesh::PointsRegion>(read.supports[3]).points, points);
    EXPECT_EQ(read.provenance, model.provenance);
    ASSERT_TRUE(read.damping.has_value());
    EXPECT_EQ(read.damping->alpha, 0.5);
    EXPECT_EQ(read.damping->beta, 0.125);
}

TEST_F(ModelFile, WhatCanBeDerivedMayBeMissing) {
    const Model model = read(two_spheres("", "", R"(, "supports": [{"sphere": {"center": [3, 0, 0], "radius": 0.1}}],
        "skin": {"vertices": [[3, 1, 0], [0, 5, 0], [1.5, 2, 2]], "triangles": [[0, 1, 2]]}, "x-note": [1])"));
    EXPECT_EQ(model.law, EquilibriumLaw::large_rotation);
    EXPECT_EQ(model.links[0].length, 5);
    EXPECT_EQ(model.links[0].zone, 0);
    EXPECT_TRUE(model.spheres[0].held);
    EXPECT_FALSE(model.spheres[1].held);
    EXPECT_EQ(model.spheres[0].inertia, Mat3(0.4 * 1e-6 * 2 * 2 * Mat3::Identity()));
    ASSERT_EQ(model.skin.size(), 3u);
    EXPECT_EQ(model.skin[2].rest, Vec3(1.5, 2, 2));
    EXPECT_NEAR(model.skin[2].shares[1].weight, 0.5, 1e-15);
}

TEST_F(ModelFile, HeldAsToldGoesBeforeTheSupports) {
    const Model model = read(
        two_spheres(R"(, "held": false)", "", R"(, "supports": [{"box": {"min": [2, -1, -1], "max": [4, 1, 1]}}])"));
    EXPECT_FALSE(model.spheres[0].held);
}

TEST_F(ModelFile, EndsOfALinkAreOrdered) {
    const Model model = read(replaced(two_spheres(), R"("a": 0, "b": 1)", R"("a": 1, "b": 0)"));
    EXPECT_EQ(model.links[0].a, 0);
    EXPECT_EQ(model.links[0].b, 1);
}

TEST_F(ModelFile, EveryFaultIsNamed) {
    const std::string good = two_spheres();
    const auto fault = [&](const std::string& what, const std::string& by) {
        return complaint(replaced(good, what, by));
    };

    EXPECT_EQ(
        complaint("{\"format\": "),
        "is not valid JSON: parse error at line 1, column 12: syntax error while parsing value - unexpected end of "
        "input; expected '[', '{', or a literal");
    EXPECT_EQ(complaint("[]"), "is '[]', but must be an object");
    EXPECT_EQ(fault("model/1", "model/2"), "format: is '\"palpate-model/2\"', but must be one of 'palpate-model/1'");
    EXPECT_EQ(fault(R"("format")", R"("x-format")"), "the field 'format' is missing");
    EXPECT_EQ(complaint(R"({"format": "palpate-model/1", "spheres": [], "links": []})"),
              "spheres: is '[]', but must be a list of at least one sphere");
    EXPECT_EQ(fault("[3, 0, 0]", "[3, 0]"), "spheres[0].center: is '[3,0]', but must be three numbers");
    EXPECT_EQ(fault("[3, 0, 0]", "[3, 0, true]"), "spheres[0].center[2]: is 'true', but must be a number");
    EXPECT_EQ(fault("\"radius\": 2", "\"radius\": 0"), "spheres[0].radius: is '0', but must be a number above 0");
    EXPECT_EQ(fault("\"radius\": 2, ", ""), "spheres[0]: the field 'radius' is missing");
    EXPECT_EQ(fault("1e-6", "-1"), "spheres[0].mass: is '-1', but must be a number of at least 0");
    EXPECT_EQ(fault("1e-6", "1e999").rfind("is not valid JSON: number overflow parsing '1e999'", 0), 0u);
    EXPECT_EQ(complaint(two_spheres(", \"inertia\": [1, 2]")),
              "spheres[0].inertia: is '[1,2]', but must be a list of 6");
    EXPECT_EQ(complaint(two_spheres(", \"held\": 1")), "spheres[0].held: is '1', but must be true or false");
    EXPECT_EQ(complaint(two_spheres(", \"heid\": 1")),
              "spheres[0]: the field 'heid' is not known (did you mean 'held'?); known are 'center', 'radius', 'mass', "
              "'inertia', 'held', 'cell', 'volume'");
    EXPECT_EQ(fault("\"b\": 1", "\"b\": 2"), "links[0].b: is '2', but must be a whole number from 0 to 1");
    EXPECT_EQ(fault("\"b\": 1", "\"b\": 0"), "links[0]: a and b are both 0; a link joins two spheres");
    EXPECT_EQ(fault("\"a\": 0", "\"a\": -1"), "links[0].a: is '-1', but must be a whole number from 0 to 1");
    EXPECT_EQ(fault("\"a\": 0", "\"a\": 0.5"), "links[0].a: is '0.5', but must be a whole number from 0 to 1");
    EXPECT_EQ(fault("[3, 0, 0]", "[0, 4, 0]"), "links[0]: spheres 0 and 1 have the same centre; move one of them");
    EXPECT_EQ(fault("1.5", "\"stiff\""), "links[0].elongation: is '\"stiff\"', but must be a number of at least 0");
    EXPECT_EQ(fault("\"flexion\": 20", "\"flexion\": -20"),
              "links[0].flexion: is '-20', but must be a number of at least 0");
    EXPECT_EQ(complaint(two_spheres("", ", \"length\": 0")), "links[0].length: is '0', but must be a number above 0");
    EXPECT_EQ(complaint(two_spheres("", ", \"gyration\": 0")),
              "links[0].gyration: is '0', but must be a number above 0");
    EXPECT_EQ(complaint(two_spheres("", ", \"shear\": 2")), "links[0]: the field 'flexion_2' is missing");
    EXPECT_EQ(complaint(two_spheres("", ", \"area\": 2")),
              "links[0].area: is of a full link's section, but the link is the paper's: give it flexion_2, shear and "
              "shear_2, or take this away");
    EXPECT_EQ(complaint(two_spheres(", \"volume\": 2")),
              "spheres[0].volume: is a stiffness against changes of the cell's volume: give the field 'cell' too "
              "[mm^3]");
    EXPECT_EQ(complaint(two_spheres("", R"(}, {"a": 1, "b": 0, "elongation": 1, "flexion": 1, "torsion": 1)")),
              "links[1]: joins spheres 0 and 1, as links[0] does already; keep one of them");
    const auto top = [&](const std::string& extra) { return complaint(two_spheres("", "", ", " + extra)); };
    EXPECT_EQ(top(R"("law": "quadratic")"), "law: is '\"quadratic\"', but must be one of 'linear', 'large-rotation'");
    EXPECT_EQ(top(R"("name": 3)"), "name: is '3', but must be a text");
    EXPECT_EQ(top(R"("provenance": [])"), "provenance: is '[]', but must be an object");
    EXPECT_EQ(top(R"("damping": {"mass": 1})"), "damping: the field 'stiffness' is missing");
    EXPECT_EQ(top(R"("damping": {"mass": -1, "stiffness": 0})"),
              "damping.mass: is '-1', but must be a number of at least 0");
    EXPECT_EQ(top(R"("skni": [])"),
              "the field 'skni' is not known (did you mean 'skin'?); known are 'format', 'name', 'law', 'spheres', "
              "'links', 'effects', 'skin', 'dent', 'damping', 'supports', 'provenance'");
}

TEST_F(ModelFile, FaultsOfEffectsAreNamed) {
    const auto effect = [&](const std::string& name, const std::string& parameters) {
        return complaint(two_spheres("", "",
                                     R"(, "effects": [{"name": "outliers", "parameters": {}}, {"name": ")" + name +
                                         R"(", "parameters": )" + parameters + "}]"));
    };
    EXPECT_EQ(complaint(two_spheres("", "", R"(, "effects": {})")), "effects: is '{}', but must be a list");
    EXPECT_EQ(complaint(two_spheres("", "", R"(, "effects": [{}])")), "effects[0]: the field 'name' is missing");
    EXPECT_EQ(complaint(two_spheres("", "", R"(, "effects": [{"name": "gravity", "value": 1}])")),
              "effects[0]: the field 'value' is not known; known are 'name', 'parameters'");
    EXPECT_EQ(effect("gravity", "3"), "effects[1].parameters: is '3', but must be an object");
    EXPECT_EQ(effect("gravity", R"({"gx": {"value": "down"}})"),
              "effects[1].parameters.gx.value: is '\"down\"', but must be a number");
    EXPECT_EQ(effect("gravity", R"({"gx": {"value": 1}})"),
              "effects[1]: effect 'gravity': the parameter 'gy' [mm/s^2] is missing");
    EXPECT_EQ(effect("compliant-support", R"({"stiffness": {"value": -1, "unit": "N/mm"}})"),
              "effects[1]: effect 'compliant-support': stiffness is -1 N/mm, but must be above 0");
    EXPECT_EQ(
        effect("inclusion", R"({"cx": {"value": 0}, "cy": {"value": 0}, "cz": {"value": 0}, "ratio": {"value": 2}})"),
        "effects[1]: effect 'inclusion': either a radius [mm] is needed, for a ball, or hx, hy and hz [mm], for a box");
    EXPECT_EQ(effect("plasticity", R"({"yield": {"value": 0, "unit": "1"}, "hardening": {"value": 1, "unit": "1"}})"),
              "effects[1]: effect 'plasticity': yield is 0, but must be above 0");
    EXPECT_EQ(effect("gravty", "{}").rfind("effects[1]: effect 'gravty' is not known (did you mean 'gravity'?)", 0),
              0u);
}

TEST_F(ModelFile, FaultsOfSkinAndSupportsAreNamed) {
    const auto skin = [&](const std::string& triangles, const std::string& attachments) {
        return complaint(two_spheres("", "",
                                     R"(, "skin": {"vertices": [[0, 0, 0]], "triangles": )" + triangles +
                                         R"(, "attachments": )" + attachments + "}"));
    };
    EXPECT_EQ(skin("[[0, 0, 1]]", "[[0, 1, 0]]"),
              "skin.triangles[0][2]: is '1', but must be a whole number from 0 to 0");
    EXPECT_EQ(skin("[[0, 0]]", "[[0, 1, 0]]"), "skin.triangles[0]: is '[0,0]', but must be a list of 3");
    EXPECT_EQ(skin("[]", "[]"), "skin.attachments: is '[]', but must be a list of 1");
    EXPECT_EQ(skin("[]", "[[0, 2, 0]]"), "skin.attachments[0][1]: is '2', but must be a whole number from 0 to 1");
    EXPECT_EQ(skin("[]", "[[0, 1, 1.5]]"), "skin.attachments[0][2]: is '1.5', but must be a number from 0 to 1");
    EXPECT_EQ(complaint(two_spheres("", "", R"(, "skin": {"vertices": [], "triangles": [[0, 0, 0]]})")),
              "skin.triangles[0][0]: is '0', but must be absent: there is nothing to point at");

    const auto support = [&](const std::string& region) {
        return complaint(two_spheres("", "", R"(, "supports": [)" + region + "]"));
    };
    EXPECT_EQ(complaint(two_spheres("", "", R"(, "supports": 3)")), "supports: is '3', but must be a list");
    EXPECT_EQ(support("{}"), "supports[0]: must have one field, one of 'box', 'sphere', 'plane', 'points'");
    EXPECT_EQ(support(R"({"cube": 1})"),
              "supports[0]: the field 'cube' is not known; known are 'box', 'sphere', 'plane', 'points'");
    EXPECT_EQ(support(R"({"box": {"min": [0, 0, 0], "max": [1, -1, 1]}})"),
              "supports[0].box: max must not lie below min");
    EXPECT_EQ(support(R"({"sphere": {"center": [0, 0, 0], "radius": -1}})"),
              "supports[0].sphere.radius: is '-1', but must be a number of at least 0");
    EXPECT_EQ(support(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 0], "within": 1}})"),
              "supports[0].plane.normal: is '[0,0,0]', but must be longer than 0");
}

TEST_F(ModelFile, MissingOnesAreAnInputOutputError) { EXPECT_THROW(read_model(folder / "none.json"), IoError); }

TEST_F(ModelFile, ForParaViewCarriesRadiusAndStiffness) {
    const std::filesystem::path vtp = folder / "skeleton.vtp";
    const Model model = make_lattice({2, 2, 1});
    write_model_vtp(vtp, model);
    const std::string text = mesh::read_text(vtp);
    for (const char* name :
         {"radius [mm]", "mass [tonne]", "elongation [N/mm]", "flexion [N*mm/rad]", "torsion [N*mm/rad]"})
        EXPECT_NE(text.find('"' + std::string(name) + '"'), std::string::npos) << name;
    EXPECT_NE(text.find("NumberOfPoints=\"4\""), std::string::npos);
    EXPECT_NE(text.find(fmt::format("NumberOfLines=\"{}\"", model.links.size())), std::string::npos);
}

}  // namespace
}  // namespace palpate::skeleton
