#include "identify/diagnosis/fit/priors/known_magnitude.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::identify {
namespace {

/// The likelihood along a direction, integrated over the known magnitude.
class AlongDirections {
public:
    AlongDirections(const Vec3& free, const Mat3& covariance, const Vec3& prior_sd, const MagnitudePrior& known)
        : P_(covariance.inverse()), h_(P_ * free), known_(known) {
        // N(g; free, C) / N(g; 0, prior) = exp(constant + h.g - g.(P - Lambda) g / 2)
        constant_ = 0.5 * (prior_sd.array().square().log().sum() - std::log(covariance.determinant()) - free.dot(h_));
        P_.diagonal() -= prior_sd.cwiseAbs2().cwiseInverse();
    }

    /// ln of the integral over r of N(r; mean, sd) exp(constant + r h.d - r^2 d.P d / 2).
    double log_likelihood(const Vec3& d) const {
        const double w = 1 / (known_.sd * known_.sd);
        const double a = d.dot(P_ * d) + w, b = h_.dot(d) + w * known_.mean;
        return constant_ + 0.5 * (b * b / a - w * known_.mean * known_.mean) + 0.5 * std::log(w / a);
    }

private:
    Mat3 P_;
    Vec3 h_;
    MagnitudePrior known_;
    double constant_;
};

/// Where a step in the tangent plane at `centre` leads on the unit sphere.
Vec3 along(const Vec3& centre, const Vec3& step) {
    const double angle = step.norm();
    return angle == 0 ? centre : Vec3(std::cos(angle) * centre + std::sin(angle) / angle * step);
}

/// Directions in a grid in the plane that touches the unit sphere, along the axes of what is uncertain there.
struct DirectionGrid {
    std::vector<Vec3> at;
    std::vector<double> log_likelihood, log_mass;  // the second times the solid angle of the cell
    std::size_t mode = 0;                          // the most likely one
};

/// `reach`: half of its sides, in sd of `covariance` (of a vector of unit length).
DirectionGrid grid_about(const Vec3& centre, const AlongDirections& directions, const Mat3& covariance, double reach) {
    constexpr int half = 200;  // fine enough for modes on an axis that is open, at whose ends the grid is coarse
    const Vec3 u = centre.unitOrthogonal(), v = centre.cross(u);
    Eigen::Matrix<double, 3, 2> T;
    T << u, v;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(T.transpose() * covariance * T);
    T *= axes.eigenvectors();
    const Eigen::Vector2d sides = (reach * axes.eigenvalues().cwiseSqrt()).cwiseMin(M_PI);
    DirectionGrid grid;
    const double log_cell = std::log(sides[0] * sides[1] / (half * half));
    for (int i = -half; i <= half; ++i)
        for (int j = -half; j <= half; ++j) {
            const Vec3 step = T * Eigen::Vector2d(i * sides[0] / half, j * sides[1] / half);
            const double angle = step.norm();
            if (angle >= M_PI) continue;
            const double spread = angle == 0 ? 0 : std::log(std::sin(angle) / angle);  // of areas
            grid.at.push_back(along(centre, step));
            grid.log_likelihood.push_back(directions.log_likelihood(grid.at.back()));
            grid.log_mass.push_back(grid.log_likelihood.back() + log_cell + spread);
            if (grid.log_likelihood.back() > grid.log_likelihood[grid.mode]) grid.mode = grid.at.size() - 1;
        }
    return grid;
}

}  // namespace

KnownMagnitude with_known_magnitude(const Vec3& free, const Mat3& covariance, const Vec3& prior_sd,
                                    const MagnitudePrior& known) {
    const AlongDirections directions(free, covariance, prior_sd, known);
    const Mat3 C = covariance / (known.mean * known.mean);
    // Wide enough for another mode on the far side, where there is one; then anew about the first, as the free fit may
    // point elsewhere; then close about it.
    constexpr double wide = 10, close = 0.5;  // sd
    const DirectionGrid first = grid_about(free.normalized(), directions, C, wide);
    const DirectionGrid all = grid_about(first.at[first.mode], directions, C, wide);
    const DirectionGrid fine = grid_about(all.at[all.mode], directions, C, close);
    const Vec3 mode = fine.at[fine.mode];

    const double most = std::ranges::max(all.log_mass);
    double sum = 0;
    Mat3 about = Mat3::Zero();
    for (std::size_t k = 0; k < all.at.size(); ++k) {
        const double weight = std::exp(all.log_mass[k] - most);
        const Vec3 off = known.mean * (all.at[k] - mode);
        sum += weight;
        about += weight * off * off.transpose();
    }
    about /= sum;
    about += known.sd * known.sd * mode * mode.transpose();
    return {known.mean * mode, about, most + std::log(sum / (4 * M_PI))};
}

}  // namespace palpate::identify
