// What other solvers read and write: decks, results of CalculiX, fields in VTK files.

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/solution/read_solution.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

namespace fs = std::filesystem;

struct SolverFiles : ::testing::Test {
    Deck deck(const std::string& text) { return read_deck(folder.write("body.inp", text)); }
    std::string deck_refusal(const std::string& text) {
        return message_of<InvalidInput>([&] { deck(text); });
    }
    TemporaryFolder folder;
};

/// a cube of edge 2 as one hexahedron with its corners 1 to 8.
const std::string deck_of_a_cube =
    "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 2, 0\n4, 0, 2, 0\n5, 0, 0, 2\n6, 2, 0, 2\n7, 2, 2, 2\n8, 0, 2, 2\n"
    "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n";

TEST_F(SolverFiles, ADeckThatWeWroteIsReadBack) {
    const VolumeMesh bar = to_quadratic(make_bar({0, 0, 0}, {4, 1, 1}, {4, 1, 1}));
    std::vector<char> held(static_cast<std::size_t>(bar.nodes.rows()), 0);
    for (Eigen::Index n = 0; n < bar.nodes.rows(); ++n) held[static_cast<std::size_t>(n)] = bar.nodes(n, 0) == 0;
    Eigen::VectorXd first = Eigen::VectorXd::Zero(3 * bar.nodes.rows()), second = first;
    first[3 * 5 + 2] = -0.25;
    second[3 * 7] = 0.125;
    write_inp(folder / "bar.inp", bar, {.held = held, .material = {0.3, 0.4, 1e-9}, .steps = {first, second}});
    const Deck deck = read_deck(folder / "bar.inp");
    EXPECT_EQ(std::ssize(deck.held), std::ranges::count(held, 1));
    EXPECT_TRUE(deck.held_in_part.empty());
    EXPECT_DOUBLE_EQ(deck.young.value(), 0.3);
    EXPECT_DOUBLE_EQ(deck.poisson.value(), 0.4);
    EXPECT_DOUBLE_EQ(deck.density.value(), 1e-9);
    ASSERT_EQ(deck.steps.size(), 2U);
    EXPECT_EQ(deck.steps[0].forces.at(6), Vec3(0, 0, -0.25));
    EXPECT_EQ(deck.steps[1].forces, (std::map<std::int64_t, Vec3>{{8, Vec3(0.125, 0, 0)}}));  // OP=NEW
    const BodyFile body = read_body(folder / "bar.inp");
    EXPECT_EQ(body.volume->tetrahedra.rows(), bar.tetrahedra.rows());
    EXPECT_TRUE(body.volume->is_quadratic());
    EXPECT_NEAR(signed_volume(body.surface), 4, 1e-12);  // rounding
}

TEST_F(SolverFiles, CellsOfAllShapesAreCutWithoutGapOrOverlap) {
    // a cube, a wedge on its side x = 2, a pyramid on its top, and a tetrahedron on the pyramid's side
    // towards -y.
    const std::string mixed = deck_of_a_cube +
                              "*NODE\n9, 4, 0, 0\n10, 4, 0, 2\n11, 1, 1, 5\n12, 1, -2, 3\n"
                              "*ELEMENT, TYPE=C3D6\n2, 2, 9, 3, 6, 10, 7\n*ELEMENT, TYPE=C3D5\n3, 5, 6, 7, 8, 11\n"
                              "*ELEMENT, TYPE=C3D4\n4, 5, 6, 11, 12\n";
    const BodyFile body = read_body(folder.write("mixed.inp", mixed));
    // 8 + 4 + 4 (base 4, height 3) + the tetrahedron
    const double tetrahedron = std::abs(Vec3(2, 0, 0).dot(Vec3(1, 1, 3).cross(Vec3(1, -2, 1)))) / 6;
    EXPECT_NEAR(element_volumes(*body.volume).sum(), 16 + tetrahedron, 1e-12);
    EXPECT_NEAR(signed_volume(body.surface), 16 + tetrahedron, 1e-12);  // the boundary is closed: no side is left over
    ASSERT_EQ(body.notes.size(), 1U);
    EXPECT_TRUE(says(body.notes.front(), {"4 cells", "cut"}));
}

TEST_F(SolverFiles, TwoHexahedraShareTheirSideWhateverTheNumbering) {
    // the second cube is numbered from another corner, so that its diagonals have to agree by node numbers
    const std::string two = deck_of_a_cube +
                            "*NODE\n9, 4, 0, 0\n10, 4, 2, 0\n11, 4, 0, 2\n12, 4, 2, 2\n"
                            "*ELEMENT, TYPE=C3D8R\n2, 10, 3, 7, 12, 9, 2, 6, 11\n";
    const BodyFile body = read_body(folder.write("two.inp", two));
    EXPECT_NEAR(signed_volume(body.surface), 16, 1e-12);
    EXPECT_EQ(body.surface.vertices.rows(), 12);  // none of the shared side's is inside, but all of them are on its rim
    for (const auto& face : body.volume->faces.rowwise())
        EXPECT_FALSE(body.volume->nodes(face[0], 0) == 2 && body.volume->nodes(face[1], 0) == 2 &&
                     body.volume->nodes(face[2], 0) == 2)
            << "a side within the body is left open";
}

TEST_F(SolverFiles, SetsBoundariesAndLoadsAreUnderstoodAsSolversDo) {
    const Deck deck = this->deck(
        "** a comment\n" + deck_of_a_cube +
        "*Nset, nset=Left, generate\n1, 8, 3\n"                     // 1, 4, 7
        "*NSET, NSET=BOTH\nLEFT, 2\n"                               // and 2
        "*BOUNDARY\nBOTH, 1, 2\n1, 3\n3, ENCASTRE\n5, 1, 3, 0.5\n"  // 1 is held, 3 too; 5 is driven, the others slide
        "*STEP, NLGEOM\n*STATIC\n*CLOAD\n6, 1, 2.\n6, 1, 1.\nLEFT, 3, -1\n*DLOAD\nE, GRAV, 9810., 0, 0, -2\n*END STEP\n"
        "*STEP\n*STATIC\n*CLOAD\n6, 1, 5.\n*END STEP\n"
        "*STEP\n*STATIC\n*CLOAD, OP=NEW\n7, 2, 1.\n*DLOAD, OP=NEW\nE, P1, 0.1\n*END STEP\n");
    EXPECT_EQ(deck.held, (std::set<std::int64_t>{1, 3}));
    EXPECT_EQ(deck.held_in_part, (std::set<std::int64_t>{2, 4, 5, 7}));
    ASSERT_EQ(deck.steps.size(), 3U);
    EXPECT_EQ(deck.steps[0].forces.at(6), Vec3(3, 0, 0));  // what one step says twice adds up
    EXPECT_EQ(deck.steps[0].forces.at(4), Vec3(0, 0, -1));
    EXPECT_EQ(deck.steps[0].gravity.value(), Vec3(0, 0, -9810));
    EXPECT_EQ(deck.steps[1].forces.at(6), Vec3(5, 0, 0));   // in place of what the step before said
    EXPECT_EQ(deck.steps[1].forces.at(4), Vec3(0, 0, -1));  // which otherwise stays
    EXPECT_EQ(deck.steps[2].forces, (std::map<std::int64_t, Vec3>{{7, Vec3(0, 1, 0)}}));
    EXPECT_FALSE(deck.steps[2].gravity);
    ASSERT_EQ(deck.steps[2].others.size(), 1U);
    EXPECT_TRUE(says(deck.steps[2].others.front(), {"*DLOAD", "body.inp, line"}));
}

TEST_F(SolverFiles, ADeckMayIncludeFilesOfItsFolder) {
    folder.write("mesh.inp", deck_of_a_cube);
    const Deck deck = this->deck("*INCLUDE, INPUT=mesh.inp\n*STEP\n*END STEP\n");
    EXPECT_EQ(deck.cells.cells.size(), 1U);
    EXPECT_EQ(deck.files.size(), 2U);
    EXPECT_TRUE(says(deck_refusal("*INCLUDE, INPUT=../mesh.inp\n"), {"line 1", "outside the folder"}));
    EXPECT_TRUE(says(deck_refusal("*INCLUDE, INPUT=body.inp\n"), {"include itself"}));
}

TEST_F(SolverFiles, IncludesThatMultiplyAreRefused) {
    // Nine levels deep, ten includes in each: a thousand million readings.
    for (int level = 1; level < 9; ++level) {
        std::string text;
        for (int i = 0; i < 10; ++i) text += "*INCLUDE, INPUT=level" + std::to_string(level + 1) + ".inc\n";
        folder.write("level" + std::to_string(level) + ".inc", text);
    }
    folder.write("level9.inc", "** nothing\n");
    EXPECT_TRUE(
        says(deck_refusal("*INCLUDE, INPUT=level1.inc\n"), {"body.inp", "1001 files", "Include each file once"}));
}

TEST_F(SolverFiles, StepsThatCarryOnTooManyLoadsAreRefused) {
    std::string text = "*NODE, NSET=ALL\n";
    for (int n = 1; n <= 5000; ++n) text += std::to_string(n) + ", " + std::to_string(n) + ", 0, 0\n";
    text += "*STEP\n*CLOAD\nALL, 1, 1.0\n*END STEP\n";
    for (int s = 0; s < 1000; ++s) text += "*STEP\n*END STEP\n";
    EXPECT_TRUE(says(deck_refusal(text), {"line 5804", "step 401", "2000000", "fewer steps"}));
}

TEST_F(SolverFiles, FaultyDecksAreRefusedByTheirLine) {
    EXPECT_TRUE(says(deck_refusal("*NODE\n1, 0, zero, 0\n"), {"line 2", "'ZERO'", "coordinate"}));
    EXPECT_TRUE(says(deck_refusal("*ELEMENT, TYPE=C3D7\n"), {"line 1", "C3D7", "allowed"}));
    EXPECT_TRUE(says(deck_refusal("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4, 5\n"), {"line 2", "has 5 nodes"}));
    EXPECT_TRUE(says(deck_refusal("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3\n"), {"3 of 4 nodes"}));
    EXPECT_TRUE(says(deck_refusal(deck_of_a_cube + "*STEP\n*CLOAD\nTOP, 3, 1\n"), {"TOP", "neither a node nor a set"}));
    EXPECT_TRUE(says(deck_refusal("*INSTANCE, NAME=A\n*END INSTANCE\n*INSTANCE, NAME=B\n"), {"second instance"}));
}

/// Results as CalculiX 2.20 writes them for one tetrahedron: two steps, the first with two increments.
std::string frd() {
    const auto block = [](int increment, int step, const std::string& time, const std::string& z) {
        char head[100];
        std::snprintf(head, sizeof head, "    1PSTEP%26d%12d%12d          \n", increment, 1, step);
        return std::string(head) + "  100CL  10" + std::to_string(increment) + " " + time +
               "           4                     0    1           1\n"
               " -4  DISP        4    1\n -5  D1          1    2    1    0\n"
               " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 0.00000E+00 0.00000E+00 0.00000E+00\n"
               " -1         3 0.00000E+00 0.00000E+00 0.00000E+00\n"
               " -1         4-1.00000E-01-2.50000E-02" +
               z + "\n -3\n";
    };
    return "    1C\n    2C                             4                                     1\n"
           " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 2.00000E+00 0.00000E+00 0.00000E+00\n"
           " -1         3 0.00000E+00 2.00000E+00 0.00000E+00\n -1         4 0.00000E+00 0.00000E+00 2.00000E+00\n -3\n"
           "    3C                             1                                     1\n"
           " -1         1    3    0    1\n -2         1         2         3         4\n -3\n" +
           block(1, 1, "0.500000000", "-1.00000E+00") + block(2, 1, "1.000000000", "-2.00000E+00") +
           block(3, 2, "2.000000000", "-3.00000E+00") + " 9999\n";
}

TEST_F(SolverFiles, ResultsOfCalculixAreReadInTheirColumns) {
    const Solution solution = read_solution(folder.write("job.frd", frd()));
    ASSERT_EQ(solution.steps.size(), 3U);
    EXPECT_EQ(solution.nodes.row(3), Eigen::RowVector3d(0, 0, 2));
    EXPECT_NEAR(element_volumes(solution.body).sum(), 4.0 / 3, 1e-12);
    EXPECT_EQ(solution.steps[0].load_step, 1);
    EXPECT_EQ(solution.steps[1].load_step, 1);
    EXPECT_EQ(solution.steps[2].load_step, 2);
    EXPECT_EQ(solution.steps[2].time, 2);
    // numbers that touch: no blank stands before a sign
    EXPECT_EQ(solution.steps[2].displacement.row(3), Eigen::RowVector3d(-0.1, -0.025, -3));
}

TEST_F(SolverFiles, FaultyResultsAreRefusedByTheirLine) {
    const auto refusal = [&](const std::string& text) {
        return message_of<InvalidInput>([&] { read_solution(folder.write("job.frd", text)); });
    };
    EXPECT_TRUE(says(refusal(frd().substr(0, frd().rfind(" -3"))), {"cut off"}));
    std::string binary = frd();
    binary.replace(binary.find("1\n -1         1 0"), 1, "3");
    EXPECT_TRUE(says(refusal(binary), {"line 2", "binary"}));
    std::string other_node = frd();
    other_node.replace(other_node.rfind(" -1         4"), 13, " -1         9");
    EXPECT_TRUE(says(refusal(other_node), {"line", "node 9"}));
    EXPECT_TRUE(says(refusal(frd().substr(0, frd().find("    1PSTEP"))), {"no displacements"}));
}

TEST_F(SolverFiles, PrintedTablesNeedTheDeckTheyCameFrom) {
    const std::string dat =
        "\n displacements (vx,vy,vz) for set SKIN and time  0.1000000E+01\n\n"
        "         6  0.100000E+00  0.000000E+00 -2.500000E-02\n\n"
        " forces (fx,fy,fz) for set SKIN and time  0.1000000E+01\n\n         6  9.0  9.0  9.0\n\n"
        " displacements (vx,vy,vz) for set TOP and time  0.1000000E+01\n\n         7  0.2  0.0  0.0\n"
        " displacements (vx,vy,vz) for set SKIN and time  0.2000000E+01\n\n         6  0.3  0.0  0.0\n";
    const fs::path file = folder.write("job.dat", dat);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_solution(file); }), {"job.dat", "no mesh", ".inp"}));
    const Deck deck = this->deck(deck_of_a_cube);
    const Solution solution = read_solution(file, &deck);
    ASSERT_EQ(solution.steps.size(), 2U);  // two sets at one time are one step
    EXPECT_EQ(solution.steps[0].displacement.row(5), Eigen::RowVector3d(0.1, 0, -0.025));
    EXPECT_EQ(solution.steps[0].displacement.row(6), Eigen::RowVector3d(0.2, 0, 0));
    EXPECT_TRUE(solution.steps[0].displacement.row(0).array().isNaN().all());
    EXPECT_EQ(solution.steps[1].time, 2);
}

TEST_F(SolverFiles, FieldsOfParaviewAreFoundByTheirNames) {
    const VolumeMesh bar = make_bar({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
    const Points u = 0.1 * bar.nodes, v = Points::Constant(bar.nodes.rows(), 3, 7);
    write_vtu(folder / "a.vtu", bar, {.points = {{"velocity", v}, {"U", u}}});
    EXPECT_EQ(read_solution(folder / "a.vtu").steps.front().displacement, u);
    EXPECT_EQ(read_solution(folder / "a.vtu", nullptr, "velocity").steps.front().displacement, v);
    write_vtu(folder / "b.vtu", bar, {.points = {{"whatever", u}}});
    EXPECT_EQ(read_solution(folder / "b.vtu").steps.front().displacement, u);  // the only one of three components
    write_vtu(folder / "c.vtu", bar, {.points = {{"one", u}, {"two", v}}});
    EXPECT_TRUE(
        says(message_of<InvalidInput>([&] { read_solution(folder / "c.vtu"); }), {"c.vtu", "'one', 'two'", "--array"}));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { read_solution(folder / "c.vtu", nullptr, "three"); }),
                     {"'three'", "'one', 'two'"}));
    const Surface surface = boundary_surface(bar);
    write_vtp(folder / "s.vtp", surface, {.points = {{"displacement", 0.2 * surface.vertices}}});
    const Solution skin = read_solution(folder / "s.vtp");
    EXPECT_EQ(skin.body.tetrahedra.rows(), 0);
    EXPECT_TRUE(skin.steps.front().displacement.isApprox(0.2 * skin.nodes));
}

}  // namespace
}  // namespace palpate::mesh
