#include "mesh/formats/label_image/label_surface.h"

#include <fmt/format.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/geometry/with_volume.h"
#include "mesh/topology/shells.h"

namespace palpate::mesh {
namespace {

constexpr std::int64_t most_along = 160;  // cells along the longest side: ten an element of the usual size
constexpr double smallest_part = 0.01;    // of the largest part's volume
constexpr double pass_band = 0.05;        // of the mesh's highest frequency: steps of voxels go, limbs stay
constexpr int smoothing_steps = 30;

using Index = std::array<std::int64_t, 3>;

/// A box of voxels that holds the label.
struct Crop {
    Index first, size;
    bool meets_border = false;
};

Crop crop_to(const LabelImage& image, int label) {
    Index low = image.size, high{-1, -1, -1};
    std::int64_t v = 0;
    for (std::int64_t z = 0; z < image.size[2]; ++z)
        for (std::int64_t y = 0; y < image.size[1]; ++y)
            for (std::int64_t x = 0; x < image.size[0]; ++x, ++v) {
                if (image.value(v) != label) continue;
                const Index at{x, y, z};
                for (std::size_t d = 0; d < 3; ++d) {
                    low[d] = std::min(low[d], at[d]);
                    high[d] = std::max(high[d], at[d]);
                }
            }
    Crop crop{low, {}};
    for (std::size_t d = 0; d < 3; ++d) {
        crop.size[d] = high[d] - low[d] + 1;
        crop.meets_border |= low[d] == 0 || high[d] == image.size[d] - 1;
    }
    return crop;
}

/// The share of the label in cells of so many voxels, with a margin of empty cells; and how cells lie in space.
struct Shares {
    Index voxels_per_cell, cells;
    vtkNew<vtkImageData> grid;
};

void fill_shares(const LabelImage& image, int label, const Crop& crop, Shares& shares) {
    for (std::size_t d = 0; d < 3; ++d) {
        shares.voxels_per_cell[d] = (crop.size[d] + most_along - 1) / most_along;
        shares.cells[d] = (crop.size[d] + shares.voxels_per_cell[d] - 1) / shares.voxels_per_cell[d] + 2;
    }
    shares.grid->SetDimensions(static_cast<int>(shares.cells[0]), static_cast<int>(shares.cells[1]),
                               static_cast<int>(shares.cells[2]));
    shares.grid->AllocateScalars(VTK_FLOAT, 1);
    auto* share = static_cast<float*>(shares.grid->GetScalarPointer());
    std::fill_n(share, shares.cells[0] * shares.cells[1] * shares.cells[2], 0.0F);
    const auto part =
        1.0F / static_cast<float>(shares.voxels_per_cell[0] * shares.voxels_per_cell[1] * shares.voxels_per_cell[2]);
    for (std::int64_t z = 0; z < crop.size[2]; ++z)
        for (std::int64_t y = 0; y < crop.size[1]; ++y)
            for (std::int64_t x = 0; x < crop.size[0]; ++x) {
                const std::int64_t voxel =
                    x + crop.first[0] + image.size[0] * (y + crop.first[1] + image.size[1] * (z + crop.first[2]));
                if (image.value(voxel) != label) continue;
                const Index cell{x / shares.voxels_per_cell[0] + 1, y / shares.voxels_per_cell[1] + 1,
                                 z / shares.voxels_per_cell[2] + 1};
                share[cell[0] + shares.cells[0] * (cell[1] + shares.cells[1] * cell[2])] += part;
            }
}

Surface from_vtk(vtkPolyData* poly) {
    Surface surface{Points(poly->GetNumberOfPoints(), 3), Triangles(poly->GetNumberOfPolys(), 3)};
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) poly->GetPoint(v, surface.vertices.row(v).data());
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    Eigen::Index t = 0;
    for (poly->GetPolys()->InitTraversal(); poly->GetPolys()->GetNextCell(count, corners); ++t)
        for (int c = 0; c < 3; ++c) surface.triangles(t, c) = static_cast<int>(corners[c]);
    return surface;
}

/// Where the share is a half, in space, turned outward.
Surface contour(const LabelImage& image, const Crop& crop, const Shares& shares) {
    vtkNew<vtkFlyingEdges3D> edges;
    edges->SetInputData(shares.grid);
    edges->SetValue(0, 0.5);
    edges->ComputeNormalsOff();
    edges->ComputeScalarsOff();
    edges->Update();
    Surface surface = from_vtk(edges->GetOutput());
    const Vec3 cell(static_cast<double>(shares.voxels_per_cell[0]), static_cast<double>(shares.voxels_per_cell[1]),
                    static_cast<double>(shares.voxels_per_cell[2]));
    const Vec3 first(static_cast<double>(crop.first[0]), static_cast<double>(crop.first[1]),
                     static_cast<double>(crop.first[2]));
    // Cell 1 begins with the crop's first voxel: its centre lies half a cell behind that voxel's near side.
    const Vec3 offset = first.array() - 0.5 - 0.5 * cell.array();
    for (auto vertex : surface.vertices.rowwise()) {
        const Vec3 voxel = offset + cell.cwiseProduct(vertex.transpose());
        vertex = (image.axes * voxel + image.origin).transpose();
    }
    if (signed_volume(surface) < 0) surface.triangles.col(1).swap(surface.triangles.col(2));
    return surface;
}

Surface joined(const std::vector<Surface>& parts) {
    Eigen::Index vertices = 0, triangles = 0;
    for (const Surface& part : parts) {
        vertices += part.vertices.rows();
        triangles += part.triangles.rows();
    }
    Surface all{Points(vertices, 3), Triangles(triangles, 3)};
    vertices = triangles = 0;
    for (const Surface& part : parts) {
        all.vertices.middleRows(vertices, part.vertices.rows()) = part.vertices;
        all.triangles.middleRows(triangles, part.triangles.rows()) =
            part.triangles.array() + static_cast<int>(vertices);
        vertices += part.vertices.rows();
        triangles += part.triangles.rows();
    }
    return all;
}

/// Without specks and pores.
Surface without_small_parts(const Surface& surface, std::vector<std::string>& notes) {
    std::vector<Surface> parts = split_parts(surface);
    double largest = 0, dropped = 0;
    for (const Surface& part : parts) largest = std::max(largest, std::abs(signed_volume(part)));
    const std::size_t before = parts.size();
    std::erase_if(parts, [&](const Surface& part) {
        const double volume = std::abs(signed_volume(part));
        const bool is_small = volume < smallest_part * largest;
        if (is_small) dropped += volume;
        return is_small;
    });
    if (parts.size() < before)
        notes.push_back(fmt::format("{} specks or pores of together {:.3g} mm^3, each below 1 % of the body, left out.",
                                    before - parts.size(), dropped));
    if (parts.size() > 1)
        notes.push_back(fmt::format("The label is {} surfaces apart: parts of the body, or cavities.", parts.size()));
    return joined(parts);
}

Surface smoothed(const Surface& surface) {
    vtkNew<vtkPolyData> poly;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(surface.vertices.rows());
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) points->SetPoint(v, surface.vertices.row(v).data());
    vtkNew<vtkCellArray> triangles;
    for (const auto& t : surface.triangles.rowwise()) triangles->InsertNextCell({t[0], t[1], t[2]});
    poly->SetPoints(points);
    poly->SetPolys(triangles);
    vtkNew<vtkWindowedSincPolyDataFilter> filter;
    filter->SetInputData(poly);
    filter->SetNumberOfIterations(smoothing_steps);
    filter->SetPassBand(pass_band);
    filter->NormalizeCoordinatesOn();
    filter->BoundarySmoothingOff();
    filter->FeatureEdgeSmoothingOff();
    filter->NonManifoldSmoothingOn();
    filter->Update();
    return from_vtk(filter->GetOutput());
}

/// A body is more than specks, lines and sheets of single voxels, which have no inside to mesh.
void require_body(const Surface& parts, double volume_of_parts, double labelled_volume, const LabelImage& image,
                  int label) {
    const double voxel = image.voxel_volume();
    const double side = image.axes.colwise().norm().minCoeff();
    const auto refuse = [&](const std::string& what) {
        throw InvalidInput(fmt::format(
            "Label {} of the image is no body: {}. Segment it anew, or give a finer image (voxels of {:.3g} mm here).",
            label, what, side));
    };
    if (parts.triangles.rows() == 0 || !(volume_of_parts > 0)) refuse("it encloses nothing");
    constexpr double fewest_voxels = 4;  // a contour cuts the corners: of a cube of two voxels a side 6 are left
    if (volume_of_parts < fewest_voxels * voxel)
        refuse(fmt::format("its surface encloses the volume of {:.3g} voxels, {:g} are needed", volume_of_parts / voxel,
                           fewest_voxels));
    constexpr double least_share = 0.5;
    if (volume_of_parts < least_share * labelled_volume)
        refuse(
            fmt::format("its surface encloses {:.0f} % of its voxels' volume, so little do they hang together; "
                        "{:.0f} % are needed",
                        100 * volume_of_parts / labelled_volume, 100 * least_share));
    // V / A is half of a sheet's thickness, a quarter of a rod's: one voxel thick, both are lost in the smoothing.
    constexpr double thinnest = 0.45;
    if (const double thickness = 2 * volume_of_parts / area(parts); thickness < thinnest * side)
        refuse(fmt::format("it is {:.2g} voxels thick in the mean (2 V / A), {:g} are needed", thickness / side,
                           thinnest));
}

/// The image with all its labels made one, 1.
LabelImage with_one_label(const LabelImage& image) {
    LabelImage one = image;
    one.type = {VoxelType::Kind::Unsigned, 1, false};
    one.slope = 1;
    one.intercept = 0;
    one.voxels.resize(static_cast<std::size_t>(image.count()));
    for (std::int64_t v = 0; v < image.count(); ++v)
        one.voxels[static_cast<std::size_t>(v)] = image.value(v) == 0 ? 0 : 1;
    return one;
}

/// `name`: "label 3".
Surface surface_of(const LabelImage& image, int label, const std::string& name, std::vector<std::string>& notes) {
    const Crop crop = crop_to(image, label);
    if (crop.meets_border) notes.push_back("The label reaches the border of the image: the body is cut off there.");
    Shares shares;
    fill_shares(image, label, crop, shares);
    const Surface all = contour(image, crop, shares);
    std::int64_t voxels = 0;
    for (std::int64_t v = 0; v < image.count(); ++v) voxels += image.value(v) == label;
    const double labelled_volume = static_cast<double>(voxels) * image.voxel_volume();
    const Surface steps = without_small_parts(all, notes);
    // What was left out is left out of the volume too; contours cut the corners of voxels off all parts alike.
    const double volume = labelled_volume * signed_volume(steps) / signed_volume(all);
    require_body(steps, signed_volume(steps), labelled_volume, image, label);
    const Surface surface = with_volume(smoothed(steps), volume);
    notes.push_back(fmt::format("The surface of {}, {} voxels of {:.3g} mm^3, smoothed; its volume is {:.4g} mm^3.",
                                name, voxels, image.voxel_volume(), signed_volume(surface)));
    return surface;
}

}  // namespace

Surface surface_of_label(const LabelImage& image, int label, std::vector<std::string>& notes) {
    return surface_of(image, label, fmt::format("label {}", label), notes);
}

Surface surface_of_all_labels(const LabelImage& image, std::vector<std::string>& notes) {
    return surface_of(with_one_label(image), 1, "all labels", notes);
}

}  // namespace palpate::mesh
