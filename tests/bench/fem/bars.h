#pragma once

#include <Eigen/SparseCore>
#include <filesystem>
#include <string>
#include <vector>

#include "fem/material.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::bench {

/// A bar of 100 x 20 x 20 mm, clamped at one end.
struct Bar {
    std::string name;
    Eigen::Vector3i cells;
    bool is_quadratic;
};

/// About 5, 20, 100 and 300 thousand nodes, of linear and of quadratic elements, and one and three million of quadratic
/// ones.
std::vector<Bar> bars();

/// What every code is given.
struct Problem {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    fem::Material material{.young = 0.1, .poisson = 0.3};
    std::vector<int> loaded;   // nodes on top: each is pulled up by 1 N, a load of its own, as Green functions are
    std::vector<int> markers;  // nodes whose displacements are compared
};

Problem make_problem(const Bar& bar, int loads);

/// Unit forces (3n x loads) [N].
Eigen::SparseMatrix<double> unit_forces(const Problem& problem);

/// Writes the problem for other codes: nodes.f64, tetrahedra.i32 (corners first), held.i32, loaded.i32 and markers.i32,
/// all in rows; material.txt; and green.inp, CalculiX's input, with Green functions for the loads.
void write_problem(const std::filesystem::path& folder, const Problem& problem);

/// Displacements at the markers for each load: loads x markers x 3, as other codes write theirs.
void write_displacements(const std::filesystem::path& file, const Problem& problem, const Eigen::MatrixXd& U);

}  // namespace palpate::bench
