#pragma once

#include <array>
#include <cmath>

#include "mesh/types.h"

namespace palpate::fem {

/// Corners of the edges whose middles carry nodes; the first three are a triangle's.
inline constexpr std::array<std::array<int, 2>, 6> edge_corners{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Shape functions at barycentric coordinates l (sum 1): tetrahedra have 4 corners, triangles 3; with as many nodes as
/// corners N_i = l_i, else corners N_i = l_i (2 l_i - 1) and midsides N_ab = 4 l_a l_b.
template <int corners, int nodes>
Eigen::Matrix<double, nodes, 1> shape(const Eigen::Matrix<double, corners, 1>& l) {
    if constexpr (nodes == corners) {
        return l;
    } else {
        Eigen::Matrix<double, nodes, 1> N;
        for (int i = 0; i < corners; ++i) N(i) = l(i) * (2 * l(i) - 1);
        for (int k = corners; k < nodes; ++k) {
            const auto [a, b] = edge_corners[k - corners];
            N(k) = 4 * l(a) * l(b);
        }
        return N;
    }
}

/// Derivatives of the shape functions along l_1, l_2, ... with l_0 = 1 - l_1 - l_2 - ... (nodes x corners - 1).
template <int corners, int nodes>
Eigen::Matrix<double, nodes, corners - 1> shape_gradient(const Eigen::Matrix<double, corners, 1>& l) {
    Eigen::Matrix<double, nodes, corners> dN = Eigen::Matrix<double, nodes, corners>::Zero();
    for (int i = 0; i < corners; ++i) dN(i, i) = nodes == corners ? 1 : 4 * l(i) - 1;
    for (int k = corners; k < nodes; ++k) {
        const auto [a, b] = edge_corners[k - corners];
        dN(k, a) = 4 * l(b);
        dN(k, b) = 4 * l(a);
    }
    return dN.template rightCols<corners - 1>().colwise() - dN.col(0);
}

/// Node positions of an element or face (nodes x 3).
template <int nodes, class Row>
Eigen::Matrix<double, nodes, 3> node_positions(const Points& points, const Row& element) {
    Eigen::Matrix<double, nodes, 3> X;
    for (int i = 0; i < nodes; ++i) X.row(i) = points.row(element(i));
    return X;
}

/// A point of a quadrature rule on the tetrahedron; weights add up to 1.
struct QuadraturePoint {
    Eigen::Vector4d l;  // barycentric
    double weight;
};

/// Exact to degree 2: all that straight-sided quadratic elements need.
inline std::array<QuadraturePoint, 4> quadrature_2() {
    const double a = (5 - std::sqrt(5.0)) / 20;
    std::array<QuadraturePoint, 4> rule;
    for (int i = 0; i < 4; ++i) {
        rule[i] = {Eigen::Vector4d::Constant(a), 0.25};
        rule[i].l(i) = 1 - 3 * a;
    }
    return rule;
}

/// Exact to degree 5, positive weights. [Walkington 2000]
inline std::array<QuadraturePoint, 14> quadrature_5() {
    constexpr double a = 0.31088591926330060980, weight_a = 0.11268792571801585080;
    constexpr double b = 0.092735250310891226402, weight_b = 0.073493043116361949544;
    constexpr double c = 0.045503704125649649492, weight_c = 0.042546020777081466438;
    std::array<QuadraturePoint, 14> rule;
    for (int i = 0; i < 4; ++i) {
        rule[i] = {Eigen::Vector4d::Constant(a), weight_a};
        rule[i].l(i) = 1 - 3 * a;
        rule[4 + i] = {Eigen::Vector4d::Constant(b), weight_b};
        rule[4 + i].l(i) = 1 - 3 * b;
    }
    for (int k = 0; k < 6; ++k) {
        rule[8 + k] = {Eigen::Vector4d::Constant(c), weight_c};
        for (const int corner : edge_corners[k]) rule[8 + k].l(corner) = 0.5 - c;
    }
    return rule;
}

/// A point of a quadrature rule on the triangle; weights add up to 1.
struct TrianglePoint {
    Vec3 l;  // barycentric
    double weight;
};

/// Exact to degree 5, as many as curved faces ask for. [Radon 1948]
inline std::array<TrianglePoint, 7> triangle_quadrature_5() {
    const double root = std::sqrt(15.0);
    std::array<TrianglePoint, 7> rule;
    rule[0] = {Vec3::Constant(1.0 / 3), 9.0 / 40};
    for (int k = 0; k < 3; ++k) {
        for (const int sign : {-1, 1}) {
            const double a = (6 + sign * root) / 21;
            TrianglePoint& point = rule[sign < 0 ? 1 + k : 4 + k];
            point = {Vec3::Constant(a), (155 + sign * root) / 1200};
            point.l(k) = 1 - 2 * a;
        }
    }
    return rule;
}

}  // namespace palpate::fem
