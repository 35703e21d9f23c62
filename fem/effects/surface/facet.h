#pragma once

#include <Eigen/Geometry>

#include "fem/effects/surface/surface_energy.h"

namespace palpate::fem {

/// The vectors of a facet's nodes, a column each.
template <int nodes>
using FacetNodes = Eigen::Matrix<double, 3, nodes>;

/// A point of a facet of the skin at which energies are taken, and the part of the facet that it stands for. Facets are
/// linear or quadratic: 3 or 6 nodes.
template <int nodes>
struct FacetPoint {
    Vec3 X;                                // where it rests
    Eigen::Matrix<double, nodes, 2> by_l;  // derivatives of the shape functions along the facet's coordinates
    double spread;                         // |G_1 x G_2|, with the tangents G = X by_l at rest [mm^2]
    double area;                           // that it stands for, at rest [mm^2]
};

/// `X`: the nodes at rest; `N`, `by_l`: shape functions there, and their derivatives; `weight`: its share of the facet.
template <int nodes>
FacetPoint<nodes> facet_point(const FacetNodes<nodes>& X, const Eigen::Matrix<double, nodes, 1>& N,
                              const Eigen::Matrix<double, nodes, 2>& by_l, double weight) {
    const Eigen::Matrix<double, 3, 2> G = X * by_l;
    const double spread = G.col(0).cross(G.col(1)).norm();
    return {X * N, by_l, spread, weight / 2 * spread};
}

/// The area J that a unit has become at a point of a facet, and its derivatives by the positions x_i of the nodes. With
/// the tangents g = x by_l, a = g_1 x g_2 and n = a / |a|,
///   J = |a| / |A|,   d|a| = n . da,   da = sum_i c_i x dx_i,   c_i = N_i,2 g_1 - N_i,1 g_2,
/// so dJ/dx_i = n x c_i / |A|. Once more, with [v] w = v x w,
///   d^2 J / dx_i dx_j = ([c_i]^T (1 - n n^T) [c_j] / |a| - (N_i,1 N_j,2 - N_j,1 N_i,2) [n]) / |A|.
template <int nodes>
class FacetStretch {
public:
    /// @pre the point has some spread.
    FacetStretch(const FacetPoint<nodes>& point, const FacetNodes<nodes>& x) : point_(point) {
        const Eigen::Matrix<double, 3, 2> g = x * point.by_l;
        const Vec3 a = g.col(0).cross(g.col(1));
        norm_ = a.norm();
        n_ = a.normalized();
        c_ = g.col(0) * point.by_l.col(1).transpose() - g.col(1) * point.by_l.col(0).transpose();
    }

    double J() const { return norm_ / point_.spread; }
    /// By node i.
    Vec3 by_node(int i) const { return n_.cross(c_.col(i)) / point_.spread; }
    /// By nodes i and j.
    Mat3 by_nodes(int i, int j) const {
        // [c_i]^T [c_j] = c_i . c_j - c_j c_i^T, and [c_i]^T n = n x c_i
        const Vec3 c_i = c_.col(i), c_j = c_.col(j), along_i = n_.cross(c_i), along_j = n_.cross(c_j);
        const Mat3 across = c_i.dot(c_j) * Mat3::Identity() - c_j * c_i.transpose() - along_i * along_j.transpose();
        const auto& N = point_.by_l;
        const double twist = N(i, 0) * N(j, 1) - N(j, 0) * N(i, 1);
        const Mat3 n_cross = (Mat3() << 0, -n_.z(), n_.y(), n_.z(), 0, -n_.x(), -n_.y(), n_.x(), 0).finished();
        return (across / norm_ - twist * n_cross) / point_.spread;
    }

private:
    const FacetPoint<nodes>& point_;
    double norm_ = 0;  // |a|
    Vec3 n_;
    FacetNodes<nodes> c_;
};

/// An energy at a point of a facet, and its derivatives by the nodes' positions.
template <int nodes>
class FacetEnergy {
public:
    FacetEnergy(const SurfaceEnergies& effects, const FacetPoint<nodes>& point, const FacetNodes<nodes>& x)
        : stretch_(point, x), area_(point.area), terms_(sum_of_terms(effects, point.X, stretch_.J())) {}

    double value() const { return area_ * terms_.w; }  // [N mm]
    Vec3 by_node(int i) const { return area_ * terms_.first * stretch_.by_node(i); }
    Mat3 by_nodes(int i, int j) const {
        return area_ * (terms_.second * stretch_.by_node(i) * stretch_.by_node(j).transpose() +
                        terms_.first * stretch_.by_nodes(i, j));
    }

private:
    FacetStretch<nodes> stretch_;
    double area_;
    AreaTerms terms_;
};

}  // namespace palpate::fem
