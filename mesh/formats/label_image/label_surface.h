#pragma once

#include <string>
#include <vector>

#include "mesh/core/surface.h"
#include "mesh/formats/label_image/label_image.h"

namespace palpate::mesh {

/// The surface round the voxels of a label [mm], smooth and outward, with the voxels' volume.
///
/// Flying edges contour the voxels, averaged to at most 160 along the longest side; a windowed sinc filter [Taubin
/// et al. 1996] takes off the steps without shrinking limbs, and a last shift along the normals makes up for what it
/// took of the volume. Parts and holes of less than 1 % of the largest part are left out; notes tell them, and that
/// the body is cut where it meets the border of the image.
Surface surface_of_label(const LabelImage& image, int label, std::vector<std::string>& notes);
/// The same round all voxels that have any label.
Surface surface_of_all_labels(const LabelImage& image, std::vector<std::string>& notes);

}  // namespace palpate::mesh
