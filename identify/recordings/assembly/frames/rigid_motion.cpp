#include "identify/recordings/assembly/frames/rigid_motion.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double on_a_line = 1e-3;  // of the extent: narrower than that is a line

Mat3 cross_matrix(const Vec3& v) {
    Mat3 X;
    X << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return X;
}

/// What is left, and how well the motion is known.
void judge(const Points& recorded, const Points& wanted, int fitted, Registration& result) {
    const Points moved = result.motion(recorded), left = moved - wanted;
    const auto n = recorded.rows();
    result.points = static_cast<int>(n);
    result.rms = std::sqrt(left.rowwise().squaredNorm().mean());
    result.largest = left.rowwise().norm().maxCoeff();
    const double free = std::max(1.0, 3.0 * static_cast<double>(n) - fitted);
    const double variance = left.squaredNorm() / free;
    result.translation_sd = std::sqrt(variance / static_cast<double>(n));
    // a turn w moves x by w x (x - c): H = sum [x - c]^T [x - c]
    const Eigen::RowVector3d centre = moved.colwise().mean();
    Mat3 H = Mat3::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
        const Mat3 X = cross_matrix((moved.row(i) - centre).transpose());
        H += X.transpose() * X;
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> turns(H);
    const double least = turns.eigenvalues()[0], most = turns.eigenvalues()[2];
    if (fitted > 3 && least > on_a_line * on_a_line * most) result.rotation_sd = std::sqrt(variance / least);
}

/// Singular values of the points about their centre, largest first.
Vec3 extents(const Points& points) {
    const Points about = points.rowwise() - points.colwise().mean();
    return Eigen::JacobiSVD<Eigen::MatrixXd>(about).singularValues().head<3>();
}

}  // namespace

Points RigidMotion::operator()(const Points& y) const {
    return (scale * (y * R.transpose())).rowwise() + t.transpose();
}

Registration fit_counterparts(const Points& recorded, const Points& wanted, bool with_scale) {
    const auto n = recorded.rows();
    if (n < 2)
        throw InvalidInput(
            fmt::format("{} point was seen of those whose place on the mesh is known; a registration takes "
                        "three, not on a line. Name more, or tell the frame (frame: {{x: ..., y: ...}}).",
                        n));
    Registration result;
    const Vec3 size = n > 2 ? extents(recorded) : Vec3(1, 0, 0);
    if (size[1] <= on_a_line * size[0]) {
        const Eigen::RowVector3d from = recorded.colwise().mean(), to = wanted.colwise().mean();
        const Eigen::Index last = n - 1;
        const Vec3 a = (recorded.row(last) - recorded.row(0)).transpose(),
                   b = (wanted.row(last) - wanted.row(0)).transpose();
        result.motion.R = Eigen::Quaterniond::FromTwoVectors(a, b).toRotationMatrix();
        if (with_scale && a.norm() > 0) result.motion.scale = b.norm() / a.norm();
        result.motion.t = to.transpose() - result.motion.scale * (result.motion.R * from.transpose());
        result.notes.push_back(
            "The points lie on a line: the turn about it is not determined, and is taken to be the least one. Add a "
            "point "
            "beside the line.");
    } else {
        const Eigen::Matrix4d T = Eigen::umeyama(recorded.transpose(), wanted.transpose(), with_scale);
        result.motion.scale = with_scale ? std::cbrt(T.topLeftCorner<3, 3>().determinant()) : 1;
        result.motion.R = T.topLeftCorner<3, 3>() / result.motion.scale;
        result.motion.t = T.topRightCorner<3, 1>();
    }
    judge(recorded, wanted, with_scale ? 7 : 6, result);
    return result;
}

Registration fit_counterparts_in_plane(const Points& recorded, const Points& wanted) {
    const auto n = recorded.rows();
    if (n < 2)
        throw InvalidInput(
            fmt::format("{} point was seen of those whose place on the mesh is known; in a plane a "
                        "registration takes two. Name more.",
                        n));
    const Eigen::RowVector3d from = recorded.colwise().mean(), to = wanted.colwise().mean();
    const Points a = recorded.rowwise() - from, b = wanted.rowwise() - to;
    const double along = a.col(0).dot(b.col(0)) + a.col(1).dot(b.col(1)),
                 across = a.col(0).dot(b.col(1)) - a.col(1).dot(b.col(0));
    Registration result;
    result.motion.R = Eigen::AngleAxisd(std::atan2(across, along), Vec3::UnitZ()).toRotationMatrix();
    result.motion.t = to.transpose() - result.motion.R * from.transpose();
    judge(recorded, wanted, static_cast<int>(n) + 3, result);
    const double spread = a.leftCols<2>().squaredNorm();
    const double variance =
        std::pow(result.rms, 2) * static_cast<double>(n) / std::max(1.0, 2.0 * static_cast<double>(n) - 3);
    result.rotation_sd = spread > 0 ? std::sqrt(variance / 2 / spread) : 0;
    result.translation_sd = std::sqrt(variance / 2 / static_cast<double>(n));
    return result;
}

Registration fit_shift(const Points& recorded, const Points& wanted, const Mat3& R) {
    if (recorded.rows() == 0)
        throw InvalidInput(
            "No point was seen whose place on the mesh is known; the axes are told, and the shift takes one such "
            "point.");
    Registration result;
    result.motion.R = R;
    result.motion.t = (wanted - recorded * R.transpose()).colwise().mean().transpose();
    judge(recorded, wanted, 3, result);
    return result;
}

double mirrored_share(const Points& recorded, const Points& wanted) {
    const Vec3 size = recorded.rows() > 3 ? extents(recorded) : Vec3(1, 1, 0);
    if (size[2] <= 10 * on_a_line * size[0]) return 1;
    Points mirrored = recorded;
    mirrored.col(0) *= -1;
    const double as_it_is = fit_counterparts(recorded, wanted).rms, other = fit_counterparts(mirrored, wanted).rms;
    return as_it_is > 0 ? other / as_it_is : 1;
}

std::string slip_of_units(double ratio) {
    struct Slip {
        double ratio;
        const char* words;
    };
    constexpr Slip slips[]{{10, "mm and cm"}, {25.4, "mm and inch"}, {100, "cm and m"}, {1000, "mm and m"}};
    constexpr double near = 0.12;  // beyond any strain of a body at rest, and less than from 10 to 25.4
    for (const Slip& slip : slips) {
        const bool is_larger = std::abs(ratio / slip.ratio - 1) < near;
        if (is_larger || std::abs(ratio * slip.ratio - 1) < near)
            return fmt::format("lengths in the recording are {:.3g} times those of the mesh, as between {}", ratio,
                               slip.words);
    }
    return {};
}

}  // namespace palpate::identify
