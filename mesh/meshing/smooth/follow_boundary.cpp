#include "mesh/meshing/smooth/follow_boundary.h"

#include <fmt/core.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <array>
#include <vector>

#include "mesh/errors.h"

namespace palpate::mesh {
namespace {

/// Neighbours within an element: the edges of the eight linear tetrahedra that its corners and midsides make.
constexpr std::array<std::array<int, 2>, 24> neighbour_pairs{
    {{0, 4}, {4, 1}, {1, 5}, {5, 2}, {2, 6}, {6, 0}, {0, 7}, {7, 3}, {1, 8}, {8, 3}, {2, 9}, {9, 3},
     {4, 5}, {5, 6}, {6, 4}, {4, 7}, {7, 8}, {8, 4}, {5, 8}, {8, 9}, {9, 5}, {6, 9}, {9, 7}, {7, 6}}};

constexpr double tolerance = 1e-13;  // turning the body shall not show

/// Numbers of the inner nodes; -1 on the boundary.
std::vector<int> number_inner(const VolumeMesh& body) {
    std::vector<int> number(static_cast<std::size_t>(body.nodes.rows()), 0);
    for (const int node : body.faces.reshaped()) number[node] = -1;
    int count = 0;
    for (int& n : number)
        if (n == 0) n = count++;
    return number;
}

}  // namespace

Points follow_boundary(const VolumeMesh& body, const Points& moves) {
    const std::vector<int> number = number_inner(body);
    std::vector<int> inner;
    for (int node = 0; node < std::ssize(number); ++node)
        if (number[node] >= 0) inner.push_back(node);
    if (inner.empty()) return moves;

    // The weighted graph: L u = 0 in each inner node.
    std::vector<Eigen::Triplet<double>> entries;
    Points pull = Points::Zero(std::ssize(inner), 3);
    for (const auto& element : body.tetrahedra.rowwise())
        for (const auto& [i, j] : neighbour_pairs) {
            const double weight = 1 / (body.nodes.row(element[i]) - body.nodes.row(element[j])).norm();
            for (const auto& [node, other] : {std::pair(element[i], element[j]), std::pair(element[j], element[i])}) {
                if (number[node] < 0) continue;
                entries.emplace_back(number[node], number[node], weight);
                if (number[other] >= 0)
                    entries.emplace_back(number[node], number[other], -weight);
                else
                    pull.row(number[node]) += weight * moves.row(other);
            }
        }
    Eigen::SparseMatrix<double> laplacian(std::ssize(inner), std::ssize(inner));
    laplacian.setFromTriplets(entries.begin(), entries.end());

    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
    solver.setTolerance(tolerance);
    solver.compute(laplacian);
    Points result = moves;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd u = solver.solve(Eigen::VectorXd(pull.col(axis)));
        if (solver.info() != Eigen::Success)
            throw SolverFailure(
                fmt::format("Smoothing the surface: the inner nodes did not settle (error {:.1e} after {} iterations). "
                            "The body's elements are too flat, use another edge length.",
                            solver.error(), solver.iterations()));
        result(inner, axis) = u;
    }
    return result;
}

}  // namespace palpate::mesh
