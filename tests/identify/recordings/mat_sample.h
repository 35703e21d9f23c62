#pragma once

#include <filesystem>

namespace palpate::identify {

/// A MATLAB file as Ncorr saves it: a grid of 2 x 3, two frames, 4 pixels skipped, 0.1 mm a pixel; u is 0.5 in frame 1
/// and 1 in frame 2, v is 0.25; the first of the grid lies outside the region.
/// @param is_even otherwise the second frame is of another size
std::filesystem::path write_ncorr(const std::filesystem::path& file, double spacing = 4, bool is_even = true);

/// As MultiDIC saves it: two points in two frames, of which the second point is not seen in the second.
std::filesystem::path write_multidic(const std::filesystem::path& file, bool is_even = true);

/// A number called `answer`.
std::filesystem::path write_other_mat(const std::filesystem::path& file);

}  // namespace palpate::identify
