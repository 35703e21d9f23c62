#include "mesh/meshing/smooth/move_nodes.h"

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace palpate::mesh {
namespace {

constexpr double least_share = 0.2;        // of the straight element's det J
constexpr double least_factor = 1 / 64.0;  // of a move: less is none

/// Gradient of the ten shape functions by three coordinates of the reference element.
using Gradient = Eigen::Matrix<double, 10, 3>;
using Corners = Eigen::Vector4d;  // barycentric

constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// N = l (2 l - 1) at corners, 4 li lj at midsides; the coordinates are l1, l2, l3 with l0 = 1 - l1 - l2 - l3.
Gradient gradient_at(const Corners& l) {
    Eigen::Matrix<double, 10, 4> by_l = Eigen::Matrix<double, 10, 4>::Zero();
    for (int i = 0; i < 4; ++i) by_l(i, i) = 4 * l[i] - 1;
    for (int s = 0; s < 6; ++s) {
        const auto [i, j] = edges[s];
        by_l(4 + s, i) = 4 * l[j];
        by_l(4 + s, j) = 4 * l[i];
    }
    return by_l.rightCols<3>().colwise() - by_l.col(0);
}

/// Where elements are looked at: corners, midsides, the four points of quadrature of degree 2.
std::vector<Gradient> gradients() {
    std::vector<Gradient> result;
    result.reserve(14);
    for (int i = 0; i < 4; ++i) result.push_back(gradient_at(Corners::Unit(i)));
    for (const auto& [i, j] : edges) result.push_back(gradient_at((Corners::Unit(i) + Corners::Unit(j)) / 2));
    const double rest = (5 - std::sqrt(5.0)) / 20;
    for (int i = 0; i < 4; ++i)
        result.push_back(gradient_at(Corners::Constant(rest) + (1 - 4 * rest) * Corners::Unit(i)));
    return result;
}

bool is_sound(const Eigen::Matrix<double, 10, 3>& nodes, double straight, const std::vector<Gradient>& places) {
    for (const Gradient& gradient : places)
        if (!((nodes.transpose() * gradient).determinant() >= least_share * straight)) return false;
    return true;
}

}  // namespace

VolumeMesh move_nodes(const VolumeMesh& body, const Points& moves) {
    const std::vector<Gradient> places = gradients();
    const Eigen::VectorXd straight = 6 * element_volumes(body);
    Eigen::VectorXd factor = moves.rowwise().any().select(Eigen::VectorXd::Ones(moves.rows()), 0.0);

    // Factors only fall and end at zero: this comes to an end.
    VolumeMesh result = body;
    for (std::set<int> held; true; held.clear()) {
        result.nodes = body.nodes + factor.asDiagonal() * moves;
        for (Eigen::Index e = 0; e < body.tetrahedra.rows(); ++e) {
            const auto nodes = body.tetrahedra.row(e);
            if (factor(nodes).isZero(0) || is_sound(result.nodes(nodes, Eigen::all), straight[e], places)) continue;
            held.insert(nodes.begin(), nodes.end());
        }
        if (held.empty()) return result;
        for (const int node : held) factor[node] = factor[node] > least_factor ? factor[node] / 2 : 0;
    }
}

}  // namespace palpate::mesh
