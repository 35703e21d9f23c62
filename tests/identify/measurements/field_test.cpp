#include "identify/measurements/field.h"

#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {
namespace {

/// A field written in metres: nodes and displacement are read in millimetres.
TEST(Field, IsConvertedToMillimetres) {
    const TemporaryFolder folder;
    const mesh::VolumeMesh bar = mesh::make_bar({0, 0, 0}, {0.1, 0.02, 0.02}, {2, 1, 1});
    const auto file = folder.path() / "1_0.vtu";
    mesh::write_vtu(file, bar, {.points = {{"displacement", Points::Constant(bar.nodes.rows(), 3, 0.003)}}});
    LoadState state;
    state.field = file;
    state.field_unit = 1000;
    const Field field = read_field(state);
    EXPECT_NEAR(field.mesh.nodes.maxCoeff(), 100, 1e-12);
    EXPECT_NEAR(field.displacement.minCoeff(), 3, 1e-12);
}

TEST(Field, WithoutDisplacementIsRefused) {
    const TemporaryFolder folder;
    LoadState state;
    state.field = folder.path() / "1_0.vtu";
    mesh::write_vtu(state.field, mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
    EXPECT_THROW(read_field(state), InvalidInput);
}

}  // namespace
}  // namespace palpate::identify
