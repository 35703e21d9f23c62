// CAD files, made here by OpenCASCADE itself.

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <IGESControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax2.hxx>

#include <numbers>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/text/atomic_file.h"
#include "mesh/topology/check_surface.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

TopoDS_Shape block(double x, double length) { return BRepPrimAPI_MakeBox(gp_Pnt(x, 0, 0), length, 20, 10); }

/// A block of 40 x 20 x 10 with a bore of radius 4 through it.
TopoDS_Shape bored_block() {
    return BRepAlgoAPI_Cut(block(0, 40), BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(20, 10, -1), gp_Dir(0, 0, 1)), 4, 12));
}
constexpr double bored_volume = 8000 - std::numbers::pi * 16 * 10;

TopoDS_Shape together(const TopoDS_Shape& a, const TopoDS_Shape& b) {
    TopoDS_Compound both;
    BRep_Builder builder;
    builder.MakeCompound(both);
    builder.Add(both, a);
    builder.Add(both, b);
    return both;
}

struct ReadCad : ::testing::Test {
    std::filesystem::path step(const std::string& name, const TopoDS_Shape& shape) {
        STEPControl_Writer writer;
        writer.Transfer(shape, STEPControl_AsIs);
        writer.Write((folder / name).c_str());
        return folder / name;
    }
    TemporaryFolder folder;
};

TEST_F(ReadCad, AStepFileGivesTheBodyWithinTheChord) {
    const BodyFile body = read_body(step("block.step", bored_block()));
    EXPECT_TRUE(body.is_in_mm);
    const SurfaceReport report = check_surface(body.surface);
    EXPECT_TRUE(report.sound());
    EXPECT_EQ(report.vertices - report.triangles / 2, 0) << "one hole goes through: Euler's characteristic is 0";
    // Chords within 0.0005 of the diagonal (45.8 mm) cut at most so much off the bore's wall of 251 mm^2.
    EXPECT_NEAR(report.volume, bored_volume, 251 * 0.0005 * 45.8);
    EXPECT_TRUE(says(body.notes.back(), {"7 CAD faces", "within 0.0229 mm"}));
}

TEST_F(ReadCad, UnitsOfTheFileAreConverted) {
    std::string text = read_text(step("block.step", bored_block()));
    const std::string millimetre = "SI_UNIT(.MILLI.,.METRE.)";
    const auto at = text.find(millimetre);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, millimetre.size(), "SI_UNIT(.CENTI.,.METRE.)");
    const BodyFile body = read_body(folder.write("block.STP", text));
    EXPECT_NEAR(bounding_box(body.surface.vertices).longest_side(), 400, 1e-6);  // digits of the file
}

TEST_F(ReadCad, IgesIsSewnTogether) {
    IGESControl_Writer writer("MM", 0);
    writer.AddShape(bored_block());
    writer.ComputeModel();
    writer.Write((folder / "block.igs").c_str());
    const BodyFile body = read_body(folder / "block.igs");
    EXPECT_TRUE(says(body.notes[0], {"7 faces", "no solid", "sewn"}));
    const RepairResult repaired = repair_surface(body.surface);
    EXPECT_NEAR(repaired.volume, bored_volume, 251 * 0.0005 * 45.8);  // by chords, as above
    EXPECT_FALSE(repaired.wrapped);
}

TEST_F(ReadCad, AnAssemblyThatTouchesIsUnitedAndTold) {
    const BodyFile body = read_body(step("two.step", together(block(0, 40), block(40, 20))));
    EXPECT_TRUE(says(body.notes[0], {"2 solids", "united to one"}));
    const SurfaceReport report = check_surface(body.surface);
    EXPECT_TRUE(report.sound());
    EXPECT_NEAR(report.volume, 12000, 1e-6);  // planes have no chords
    const BodyFile apart = read_body(step("apart.step", together(block(0, 40), block(50, 20))));
    EXPECT_TRUE(says(apart.notes[0], {"2 solids", "2 are left that do not touch", "held"}));
    EXPECT_EQ(check_surface(apart.surface).components, 2);
}

TEST_F(ReadCad, WhatIsNoCadFileIsRefused) {
    const auto refusal = [&](const std::string& name, const std::string& text) {
        return message_of<InvalidInput>([&] { read_body(folder.write(name, text)); });
    };
    EXPECT_TRUE(says(refusal("a.step", "solid x"), {"a.step", "no faces", "STEP"}));
    EXPECT_TRUE(says(refusal("a.iges", "solid x"), {"a.iges", "no faces"}));
    EXPECT_TRUE(says(message_of<IoError>([&] { read_body(folder / "none.step"); }), {"none.step", "no such file"}));
    const auto whole = step("b.step", bored_block());
    std::filesystem::resize_file(whole, std::filesystem::file_size(whole) / 2);
    EXPECT_FALSE(message_of<InvalidInput>([&] { read_body(whole); }).empty());
}

}  // namespace
}  // namespace palpate::mesh
