#include "identify/models/marker_frames.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "skeleton/model/state.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {
namespace {

/// A displacement field at the nodes, as a vector of degrees of freedom (3n).
template <class Field>
Eigen::VectorXd nodal(const mesh::VolumeMesh& mesh, const Field& field) {
    Eigen::VectorXd u(mesh.nodes.size());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) u.segment<3>(3 * i) = field(mesh.nodes.row(i).transpose());
    return u;
}

class Frames : public testing::Test {
protected:
    SmallBody body_;
    std::vector<Marker> markers_ = SmallBody::with_pins();
    MarkerFrames frames_{body_.mesh, markers_};
};

TEST_F(Frames, AreAtRestWhereTheMarkersAre) {
    const Eigen::VectorXd u = Eigen::VectorXd::Zero(body_.mesh.nodes.size());
    for (const bool small_strain : {false, true}) {
        const Points x = frames_.positions(u, small_strain);
        for (std::size_t m = 0; m < markers_.size(); ++m) {
            EXPECT_LT((x.row(static_cast<Eigen::Index>(m)).transpose() - markers_[m].rest).norm(), 1e-13);  // rounding
        }
    }
}

TEST_F(Frames, FollowRigidMotionsExactly) {
    for (const double angle : {0.01, 1.0, 3.0}) {
        const Mat3 R = skeleton::rotation(angle * Vec3(1, -2, 2) / 3);
        const Vec3 t(5, -7, 3);
        const Points x =
            frames_.positions(nodal(body_.mesh, [&](const Vec3& X) -> Vec3 { return R * X + t - X; }), false);
        for (std::size_t m = 0; m < markers_.size(); ++m) {
            const Vec3 expected = R * markers_[m].rest + t;
            // rounding, of differences over a hundredth of the body
            EXPECT_LT((x.row(static_cast<Eigen::Index>(m)).transpose() - expected).norm(), 1e-11) << angle << " " << m;
        }
    }
}

TEST_F(Frames, OfSmallStrainTurnByTheSkewPartOnly) {
    Mat3 H;
    H << 0.03, 0.02, -0.01, 0.005, -0.02, 0.04, 0.02, -0.03, 0.01;
    const Mat3 skew = 0.5 * (H - H.transpose());
    const Points x = frames_.positions(nodal(body_.mesh, [&](const Vec3& X) -> Vec3 { return H * X; }), true);
    for (std::size_t m = 0; m < markers_.size(); ++m) {
        const Vec3 anchor = markers_[m].anchor.value_or(markers_[m].rest), offset = markers_[m].rest - anchor;
        const Vec3 expected = markers_[m].rest + H * anchor + skew * offset;
        EXPECT_LT((x.row(static_cast<Eigen::Index>(m)).transpose() - expected).norm(), 1e-11);  // rounding
    }
}

TEST_F(Frames, KeepTheirLengthWhateverTheStretch) {
    const Mat3 F = skeleton::rotation(Vec3(0.4, 1.1, -0.3)) * Vec3(1.5, 0.8, 0.9).asDiagonal();
    const Eigen::VectorXd u = nodal(body_.mesh, [&](const Vec3& X) -> Vec3 { return F * X - X; });
    const Points x = frames_.positions(u, false);
    for (std::size_t m = 0; m < markers_.size(); ++m) {
        if (!markers_[m].anchor) continue;
        const Vec3 anchor = *markers_[m].anchor;
        EXPECT_NEAR((x.row(static_cast<Eigen::Index>(m)).transpose() - F * anchor).norm(), 6, 1e-11);  // rounding
    }
}

TEST_F(Frames, OnTheSurfaceInterpolate) {
    // A quadratic field, which quadratic elements hold exactly.
    const auto field = [](const Vec3& X) -> Vec3 {
        return {0.001 * X.x() * X.x(), 0.02 * X.z(), 0.002 * X.x() * X.y()};
    };
    const Points x = frames_.positions(nodal(body_.mesh, field), false);
    for (std::size_t m = 0; m < markers_.size(); ++m) {
        if (markers_[m].anchor) continue;
        const Vec3 expected = markers_[m].rest + field(markers_[m].rest);
        EXPECT_LT((x.row(static_cast<Eigen::Index>(m)).transpose() - expected).norm(), 1e-11);  // rounding
    }
}

TEST_F(Frames, HaveTheirDerivative) {
    const Mat3 F = skeleton::rotation(Vec3(0.4, 1.1, -0.3)) * Vec3(1.2, 0.9, 0.95).asDiagonal();
    const Eigen::VectorXd u = nodal(body_.mesh, [&](const Vec3& X) -> Vec3 { return F * X - X; });
    const Eigen::VectorXd direction = nodal(body_.mesh, [](const Vec3& X) -> Vec3 {
        return {std::sin(0.2 * X.y()), std::cos(0.1 * X.x() + X.z()), std::sin(0.3 * X.x())};
    });
    for (const bool small_strain : {false, true}) {
        constexpr double h = 1e-5;
        const Points difference =
            (frames_.positions(u + h * direction, small_strain) - frames_.positions(u - h * direction, small_strain)) /
            (2 * h);
        const Eigen::VectorXd moved = frames_.derivative(u, small_strain) * direction;
        // central differences of step 1e-5 carry about eight digits
        EXPECT_LT((Eigen::Map<const Points>(moved.data(), difference.rows(), 3) - difference).norm(),
                  1e-7 * difference.norm());
    }
}

}  // namespace
}  // namespace palpate::identify
