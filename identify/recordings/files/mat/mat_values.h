#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::identify {

/// Displacements of a grid of pixels, as Ncorr keeps them, or points in space, as MultiDIC does. One of both is empty.
struct MatCorrelation {
    std::vector<Eigen::MatrixXd> u, v;  // a frame each; (rows x columns) of the grid, 0 outside the region of interest
    double spacing = 0;                 // pixels that are skipped between two of the grid
    double unit_per_pixel = 1;
    std::string unit;

    std::vector<Eigen::MatrixXd> points, displacements;  // a frame each; (n x 3)
    std::vector<std::string> variables;                  // what the file holds
};

/// Of a MATLAB file, of version 5 to 7.3. A child process reads it: a broken file does no harm.
/// @throws InvalidInput where it is no whole MATLAB file.
MatCorrelation read_mat_correlation(const std::filesystem::path& file);

}  // namespace palpate::identify
