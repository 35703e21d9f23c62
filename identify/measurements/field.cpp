#include "identify/measurements/field.h"

#include <fmt/format.h>

#include <algorithm>

#include "fem/interpolation/interpolation.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::identify {

Field read_field(const LoadState& state) {
    mesh::MeshData data;
    Field field{mesh::read_vtu(state.field, &data), {}};
    const auto found = std::ranges::find(data.points, "displacement", &mesh::DataArray::name);
    if (found == data.points.end() || found->values.cols() != 3) {
        throw InvalidInput(
            fmt::format("{}: no point array 'displacement' of three components; write one row "
                        "for each node of the mesh at rest",
                        state.field.string()));
    }
    field.mesh.nodes *= state.field_unit;
    field.displacement = state.field_unit * found->values;
    return field;
}

MeasurementSet with_markers_of_fields(const MeasurementSet& set, int markers) {
    const auto has_readings = [](const LoadState& state) { return !state.readings.empty(); };
    const auto has_field = [](const LoadState& state) { return !state.field.empty(); };
    if (std::ranges::any_of(set.states, has_readings) || std::ranges::none_of(set.states, has_field)) return set;

    // vertices at even steps through the surface's list
    MeasurementSet result = set;
    const auto vertices = static_cast<int>(set.rest_surface.vertices.rows());
    const int count = std::min(vertices, markers);
    Points rest(count, 3);
    result.markers.clear();
    for (int i = 0; i < count; ++i) {
        rest.row(i) = set.rest_surface.vertices.row(static_cast<Eigen::Index>(i) * vertices / count);
        result.markers.push_back({i, rest.row(i), std::nullopt});
    }
    for (LoadState& state : result.states) {
        if (state.field.empty()) continue;
        const Field field = read_field(state);
        const Points moved = rest + fem::interpolation(field.mesh, rest) * field.displacement;
        for (int i = 0; i < count; ++i) state.readings.push_back({i, moved.row(i), missing});
    }
    return result;
}

}  // namespace palpate::identify
