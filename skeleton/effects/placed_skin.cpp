#include "skeleton/effects/placed_skin.h"

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::skeleton {

std::vector<SkinTriangle> skin_triangles(const Model& model) {
    if (model.skin.empty() || model.surface.triangles.rows() == 0)
        throw InvalidInput("the model has no skin, on which an effect acts: give it one, or take the effect away");
    Eigen::Matrix<double, 3, 2> by_l;
    by_l << -1, -1, 1, 0, 0, 1;
    std::vector<SkinTriangle> triangles;
    for (const auto& corners : model.surface.triangles.rowwise()) {
        Mat3 X;
        for (int v = 0; v < 3; ++v) X.col(v) = model.skin[corners[v]].rest;
        const fem::FacetPoint<3> at_rest = fem::facet_point<3>(X, Vec3::Constant(1.0 / 3), by_l, 1);
        constexpr double flat = 1e-9;  // twice the area, of the square of a side
        const double side = std::max((X.col(1) - X.col(0)).squaredNorm(), (X.col(2) - X.col(0)).squaredNorm());
        if (at_rest.spread > flat * side) triangles.push_back({{corners[0], corners[1], corners[2]}, at_rest});
    }
    return triangles;
}

PlacedSkin::PlacedSkin(const Model& model, fem::SurfaceEnergies effects) : effects_(std::move(effects)) {
    if (effects_.empty()) return;
    rest_ = rest_state(model);
    for (const SkinTriangle& triangle : skin_triangles(model)) {
        const auto& v = triangle.corners;
        triangles_.push_back({{model.skin[v[0]], model.skin[v[1]], model.skin[v[2]]}, triangle.at_rest});
    }
}

PlacedSkin::Corners PlacedSkin::at(const Triangle& triangle, const State& state) const {
    return {CarriedPoint(triangle.corners[0], rest_, state), CarriedPoint(triangle.corners[1], rest_, state),
            CarriedPoint(triangle.corners[2], rest_, state)};
}

fem::FacetEnergy<3> PlacedSkin::energy(const Triangle& triangle, const Corners& x) const {
    Mat3 positions;
    for (int v = 0; v < 3; ++v) positions.col(v) = x[v].x();
    return {effects_, triangle.at_rest, positions};
}

double PlacedSkin::energy(const State& state) const {
    double sum = 0;
    for (const Triangle& triangle : triangles_) sum += energy(triangle, at(triangle, state)).value();
    return sum;
}

void PlacedSkin::add_gradient(const State& state, double factor, Eigen::VectorXd& sum) const {
    for (const Triangle& triangle : triangles_) {
        const Corners x = at(triangle, state);
        const fem::FacetEnergy<3> own = energy(triangle, x);
        for (int v = 0; v < 3; ++v) {
            const Vec3 by_x = factor * own.by_node(v);
            for (int i = 0; i < x[v].shares(); ++i)
                sum.segment<6>(Eigen::Index{6} * x[v].sphere(i)) += x[v].jacobian(i).transpose() * by_x;
        }
    }
}

}  // namespace palpate::skeleton
