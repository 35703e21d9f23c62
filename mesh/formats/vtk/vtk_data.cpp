#include "mesh/formats/vtk/vtk_data.h"

#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <string>

#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_errors.h"
#include "mesh/system/bytes.h"
#include "mesh/system/child_process.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

template <class Archive>
void serialize(Archive& archive, DataArray& array) {
    archive(array.name, array.values);
}

template <class Archive>
void serialize(Archive& archive, VtkData& data) {
    archive(data.points, data.types, data.corners, data.ends, data.of_points, data.of_cells, data.of_file);
}

namespace {

namespace fs = std::filesystem;

constexpr double entries_per_byte = 1000;   // zlib packs no denser
constexpr std::size_t most_head = 1 << 20;  // [bytes] that are looked through

/// @throws InvalidInput where the head announces more than a file of this size can hold.
void check_head(const fs::path& file) {
    // of XML, and of a legacy file
    static const std::regex count(
        R"re((?:NumberOf\w+\s*=\s*["']\s*|(?:^|\n)(?:POINTS|CELLS|CELL_TYPES|VERTICES|LINES|POLYGONS|TRIANGLE_STRIPS|POINT_DATA|CELL_DATA|OFFSETS|DIMENSIONS)\s+)(\d+))re");
    std::string head(most_head, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    head.resize(std::min(head.size(), head.find("<AppendedData")));
    std::error_code error;
    const auto bytes = static_cast<double>(fs::file_size(file, error));
    for (auto it = std::sregex_iterator(head.begin(), head.end(), count); it != std::sregex_iterator(); ++it) {
        if (std::strtod((*it)[1].str().c_str(), nullptr) > entries_per_byte * bytes) {
            throw InvalidInput(
                fmt::format("{}: announces {} entries in {} bytes. The file is cut off or broken: write it again.",
                            file.string(), (*it)[1].str(), bytes));
        }
    }
}

void require_file(const fs::path& file) {
    if (!fs::is_regular_file(file)) throw IoError(fmt::format("{}: no such file.", file.string()));
    if (!std::ifstream(file)) throw IoError(fmt::format("{}: cannot be opened for reading.", file.string()));
}

template <class Reader>
auto update(const fs::path& file, const char* kind) {
    const VtkErrors errors;
    vtkNew<Reader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    if (errors.heard() || reader->GetErrorCode() != 0)
        throw InvalidInput(fmt::format("{}: this is no whole {}. Write it again, or convert it.", file.string(), kind));
    return vtkSmartPointer(reader->GetOutput());
}

/// Arrays with so many rows; -1: any. @throws InvalidInput where one has other ones.
std::vector<DataArray> arrays_of(vtkFieldData* source, Eigen::Index rows, const fs::path& file) {
    std::vector<DataArray> arrays;
    for (int a = 0; a < source->GetNumberOfArrays(); ++a) {
        vtkDataArray* values = source->GetArray(a);  // none for an array of texts
        if (!values || !values->GetName()) continue;
        DataArray& array = arrays.emplace_back();
        array.name = values->GetName();
        array.values.resize(values->GetNumberOfTuples(), values->GetNumberOfComponents());
        if (rows >= 0 && array.values.rows() != rows)
            throw InvalidInput(fmt::format("{}: array {} has {} rows, but there are {} points or cells.", file.string(),
                                           cited(array.name), array.values.rows(), rows));
        for (Eigen::Index i = 0; i < array.values.rows(); ++i)
            for (Eigen::Index c = 0; c < array.values.cols(); ++c)
                array.values(i, c) = values->GetComponent(i, static_cast<int>(c));
    }
    return arrays;
}

void take_points(vtkPointSet* source, VtkData& data) {
    data.points.resize(source->GetNumberOfPoints(), 3);
    for (Eigen::Index i = 0; i < data.points.rows(); ++i) source->GetPoint(i, data.points.row(i).data());
}

/// Appends the corners of these cells. @throws InvalidInput naming the cell that names none of the points.
void take_corners(vtkCellArray* cells, const fs::path& file, VtkData& data) {
    vtkDataArray* offsets = cells->GetOffsetsArray();
    vtkDataArray* connectivity = cells->GetConnectivityArray();
    const auto offset = [&](vtkIdType c) { return static_cast<std::int64_t>(offsets->GetTuple1(c)); };
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
        const std::int64_t begin = offset(c), end = offset(c + 1);
        if (begin < 0 || end < begin || end > connectivity->GetNumberOfTuples())
            throw InvalidInput(fmt::format("{}: the corners of cell {} are those from {} to {} of {}.", file.string(),
                                           data.ends.size(), begin, end, connectivity->GetNumberOfTuples()));
        for (std::int64_t i = begin; i < end; ++i) {
            const auto point = static_cast<std::int64_t>(connectivity->GetTuple1(i));
            if (point < 0 || point >= data.points.rows())
                throw InvalidInput(fmt::format("{}: cell {} names point {}, but there are {}.", file.string(),
                                               data.ends.size(), point, data.points.rows()));
            data.corners.push_back(point);
        }
        data.ends.push_back(static_cast<std::int64_t>(data.corners.size()));
    }
}

void take_arrays(vtkDataSet* source, const fs::path& file, VtkData& data) {
    data.of_points = arrays_of(source->GetPointData(), data.points.rows(), file);
    data.of_cells = arrays_of(source->GetCellData(), static_cast<Eigen::Index>(data.types.size()), file);
    data.of_file = arrays_of(source->GetFieldData(), -1, file);
}

VtkData grid_in(vtkUnstructuredGrid* grid, const fs::path& file) {
    VtkData data;
    take_points(grid, data);
    for (Eigen::Index i = 0; i < data.points.rows(); ++i)
        if (!(data.points.row(i).array().abs() < beyond_all_units).all())
            throw InvalidInput(
                fmt::format("{}: point {} has a coordinate that is not finite, or beyond 1e30.", file.string(), i));
    if (grid->GetNumberOfCells() > 0) {
        take_corners(grid->GetCells(), file, data);
        vtkUnsignedCharArray* types = grid->GetCellTypesArray();
        data.types.assign(types->GetPointer(0), types->GetPointer(0) + types->GetNumberOfTuples());
    }
    if (data.types.size() != data.ends.size())
        throw InvalidInput(
            fmt::format("{}: holds {} types for {} cells.", file.string(), data.types.size(), data.ends.size()));
    take_arrays(grid, file, data);
    return data;
}

VtkData poly_data_in(vtkPolyData* poly, const fs::path& file) {
    VtkData data;
    take_points(poly, data);
    for (const auto& [cells, type] : {std::pair(poly->GetVerts(), VTK_POLY_VERTEX),
                                      {poly->GetLines(), VTK_POLY_LINE},
                                      {poly->GetPolys(), VTK_POLYGON},
                                      {poly->GetStrips(), VTK_TRIANGLE_STRIP}}) {
        take_corners(cells, file, data);
        data.types.resize(data.ends.size(), type);
    }
    take_arrays(poly, file, data);
    return data;
}

VtkData legacy_in(const fs::path& file) {
    const auto object = update<vtkGenericDataObjectReader>(file, "legacy VTK file");
    if (auto* grid = vtkUnstructuredGrid::SafeDownCast(object)) return grid_in(grid, file);
    if (auto* poly = vtkPolyData::SafeDownCast(object)) return poly_data_in(poly, file);
    throw InvalidInput(
        fmt::format("{}: holds a {}; a DATASET of POLYDATA or UNSTRUCTURED_GRID is allowed. Export the body as one.",
                    file.string(), object ? object->GetClassName() : "nothing"));
}

}  // namespace

std::span<const std::int64_t> VtkData::cell(std::size_t c) const {
    const auto begin = c == 0 ? 0 : ends[c - 1];
    return {corners.data() + begin, corners.data() + ends[c]};
}

VtkData read_own_vtk(const fs::path& file, VtkKind kind) {
    require_file(file);
    switch (kind) {
        case VtkKind::unstructured_grid:
            return grid_in(update<vtkXMLUnstructuredGridReader>(file, "VTU file (VTK XML unstructured grid)"), file);
        case VtkKind::poly_data:
            return poly_data_in(update<vtkXMLPolyDataReader>(file, "VTP file (VTK XML PolyData)"), file);
        case VtkKind::legacy:
            break;
    }
    return legacy_in(file);
}

VtkData read_vtk(const fs::path& file, VtkKind kind) {
    require_file(file);
    check_head(file);
    ChildResult child = run_in_child(
        [&] {
            std::string refusal;
            VtkData data;
            try {
                data = read_own_vtk(file, kind);
            } catch (const InvalidInput& error) {
                refusal = error.what();
            }
            return to_bytes(refusal, data);
        },
        {.seconds = 120, .mebibytes = 4096});
    // VTK's parser goes beyond its arrays where a compressed block lies
    if (child.end != ChildResult::End::Answered) {
        throw InvalidInput(fmt::format(
            "{}: breaks what reads VTK files, or asks for more than 4 GiB. The file is broken: write it again.",
            file.string()));
    }
    std::string refusal;
    VtkData data;
    from_bytes(std::move(child.answer), refusal, data);
    if (!refusal.empty()) throw InvalidInput(refusal);
    return data;
}

bool is_flat(int type) {
    static const auto flat = [] {
        std::array<bool, VTK_NUMBER_OF_CELL_TYPES> of_type{};
        for (int t = 0; t < VTK_NUMBER_OF_CELL_TYPES; ++t) {
            const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(t));
            of_type[static_cast<std::size_t>(t)] = cell && cell->GetCellDimension() < 3;
        }
        return of_type;
    }();
    return type >= 0 && type < VTK_NUMBER_OF_CELL_TYPES && flat[static_cast<std::size_t>(type)];
}

}  // namespace palpate::mesh
