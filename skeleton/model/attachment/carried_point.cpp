#include "skeleton/model/attachment/carried_point.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "skeleton/model/turning_curvature.h"

namespace palpate::skeleton {

namespace {

Mat3 identity_times(double a) { return a * Mat3::Identity(); }

Mat3 twice_symmetric(const Mat3& A) { return A + A.transpose(); }

// The mean motion of the spheres that carry a point.
struct MeanMotion {
    MeanMotion(const Attachment& point, const State& rest, const State& state) {
        const SphereInfluence& most = *std::ranges::max_element(point.shares, {}, &SphereInfluence::weight);
        const Eigen::Quaterniond reference(state.R[most.sphere]);
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        q.reserve(point.shares.size());
        for (const SphereInfluence& share : point.shares) {
            Eigen::Quaterniond own(state.R[share.sphere]);
            if (own.dot(reference) < 0) own.coeffs() = -own.coeffs();
            sum += share.weight * own.coeffs();
            q.push_back(own);
            X += share.weight * rest.x.row(share.sphere).transpose();
            x += share.weight * state.x.row(share.sphere).transpose();
        }
        n = sum.norm();
        mean = Eigen::Quaterniond(Eigen::Vector4d(sum / n));
        R = mean.toRotationMatrix();
    }

    std::vector<Eigen::Quaterniond> q;  // of each sphere, on the side of the mean
    Vec3 X = Vec3::Zero(), x = Vec3::Zero();
    double n = 1;  // |sum w_i q_i|
    Eigen::Quaterniond mean;
    Mat3 R;
};

}  // namespace

Vec3 carried_place(const Attachment& point, const State& rest, const State& state) {
    const MeanMotion to(point, rest, state);
    Vec3 arm = point.rest - to.X;  // turned back by R
    for (std::size_t i = 0; i < point.shares.size(); ++i) {
        const SphereInfluence& share = point.shares[i];
        const Vec3 y = to.R.transpose() * (state.x.row(share.sphere).transpose() - to.x);
        const Vec3 Y = rest.x.row(share.sphere).transpose() - to.X;
        const Vec3 v = to.R.transpose() * (to.q[i] * to.mean.conjugate()).vec();
        arm += share.follow.leftCols<3>() * (y - Y) - share.weight * (y - Y) +
               2 * (share.follow.rightCols<3>() * v + share.weight * (point.rest - to.X).cross(v));
    }
    return to.x + to.R * arm;
}

// A step turns q_i to exp(t_i) q_i, and with it the mean by m = sum B_i t_i to first order, B_i = w_i (c_i - [v_i]) /
// n.
CarriedPoint::CarriedPoint(const Attachment& point, const State& rest, const State& state) {
    of_.reserve(point.shares.size());
    const MeanMotion to(point, rest, state);
    const Mat3& R = to.R;
    n_ = to.n;

    arm_ = R * (point.rest - to.X);
    Mat3 all_moves = Mat3::Zero(), by_mean = Mat3::Zero();
    for (std::size_t i = 0; i < point.shares.size(); ++i) {
        const SphereInfluence& share = point.shares[i];
        Carrier own;
        own.sphere = share.sphere;
        own.w = share.weight;
        own.y = state.x.row(own.sphere).transpose() - to.x;
        const Eigen::Quaterniond relative = to.q[i] * to.mean.conjugate();
        own.c = relative.w();
        own.v = relative.vec();
        own.moves = R * (share.follow.leftCols<3>() - identity_times(own.w)) * R.transpose();
        own.turns = R * (share.follow.rightCols<3>() + own.w * skew(point.rest - to.X)) * R.transpose();
        const Mat3 turned = identity_times(own.c) - skew(own.v);
        own.mean_turn = (own.w / n_) * turned;
        const Vec3 Y = R * (rest.x.row(own.sphere).transpose() - to.X);
        arm_ += own.moves * (own.y - Y) + 2 * own.turns * own.v;
        all_moves += own.moves;
        by_mean += own.moves * skew(own.y) - own.turns * turned;
        own.jacobian << own.moves, own.turns * turned;
        of_.push_back(own);
    }
    x_ = to.x + arm_;
    by_mean -= skew(arm_);
    for (Carrier& own : of_) {
        own.jacobian.leftCols<3>() += own.w * (Mat3::Identity() - all_moves);
        own.jacobian.rightCols<3>() += by_mean * own.mean_turn;
    }
}

// To second order, with m the first order of the mean's turn, d_i = t_i - m and y_i -> y_i + dy_i, f . p changes by
//   m' H m / 2 + sum m' Z_i dy_i + sum m' Y_i t_i + sum tau_i |t_i|^2 / 2;
// what the mean turns by beyond m, (m sum w_i v_i . t_i / 2 - sum w_i |t_i|^2 v_i / 4) / n, is in Y and tau.
Eigen::MatrixXd CarriedPoint::curvature(const Vec3& f) const {
    const int k = shares();
    const Mat3 F = skew(f);
    Mat3 H = turning_curvature(f, arm_), all_Z = Mat3::Zero();
    Vec3 N = arm_.cross(f);
    std::vector<Mat3> Z(k), Y(k);
    std::vector<double> tau(k);
    for (int i = 0; i < k; ++i) {
        const Carrier& own = of_[i];
        const Vec3 e = own.moves.transpose() * f, h = own.turns.transpose() * f;
        const Vec3 b = own.c * h + own.v.cross(h);
        const Mat3 W = F * own.turns * (identity_times(own.c) - skew(own.v));
        const double s = h.dot(own.v) / 4;
        H += turning_curvature(e, own.y) - twice_symmetric(F * own.moves * skew(own.y)) + twice_symmetric(W) -
             identity_times(2 * s);
        Z[i] = skew(e) - F * own.moves;
        Y[i] = identity_times(2 * s) - W + 0.5 * skew(b);
        tau[i] = -2 * s;
        all_Z += Z[i];
        N -= own.y.cross(e) + b;
    }
    for (int i = 0; i < k; ++i) {
        const double share = of_[i].w / (2 * n_);
        Y[i] += share * N * of_[i].v.transpose();
        tau[i] -= share * N.dot(of_[i].v);
        Z[i] -= of_[i].w * all_Z;
    }

    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * k, 6 * k);
    for (int i = 0; i < k; ++i) {
        const Mat3& B_i = of_[i].mean_turn;
        for (int j = 0; j < k; ++j) {
            const Mat3& B_j = of_[j].mean_turn;
            result.block<3, 3>(6 * i + 3, 6 * j + 3) = B_i.transpose() * (H * B_j + Y[j]) + Y[i].transpose() * B_j;
            const Mat3 mixed = B_i.transpose() * Z[j];
            result.block<3, 3>(6 * i + 3, 6 * j) = mixed;
            result.block<3, 3>(6 * j, 6 * i + 3) = mixed.transpose();
        }
        result.block<3, 3>(6 * i + 3, 6 * i + 3).diagonal().array() += tau[i];
    }
    return result;
}

}  // namespace palpate::skeleton
