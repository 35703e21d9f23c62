#include "skeleton/runtime/kernels/skinning.h"

#include <algorithm>
#include <numeric>

#include "skeleton/lanes.h"
#include "skeleton/model/state.h"
#include "skeleton/runtime/forces/carried.h"

namespace palpate::runtime {

using namespace skeleton::lanewise;

namespace {

using Eight = float __attribute__((vector_size(32)));
// A typedef: from an alias Clang takes no alignment.
typedef float EightInMemory __attribute__((vector_size(32), aligned(4), may_alias));

PALPATE_INLINE Eight eight(const float* p) { return *reinterpret_cast<const EightInMemory*>(p); }
PALPATE_INLINE Eight root(Eight a) {
    Eight r;
    for (int i = 0; i < Skinning::width; ++i) r[i] = __builtin_sqrtf(a[i]);
    return r;
}

struct Eight3 {
    Eight x, y, z;
};
struct EightPose {
    Eight x, y, z, qx, qy, qz, qw;
};

// Rows of eight, transposed: lane i of each result comes from the row of sphere i.
PALPATE_INLINE EightPose poses_of(const float* rows, const int* sphere) {
    Eight r[8];
    for (int i = 0; i < 8; ++i) r[i] = eight(rows + static_cast<long>(row_length) * sphere[i]);
    Eight pair[8], four[8];
    for (int i = 0; i < 8; i += 2) {
        pair[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        pair[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 8; i += 4) {
        four[i] = __builtin_shufflevector(pair[i], pair[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        four[i + 1] = __builtin_shufflevector(pair[i], pair[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        four[i + 2] = __builtin_shufflevector(pair[i + 1], pair[i + 3], 0, 1, 8, 9, 4, 5, 12, 13);
    }
    four[3] = __builtin_shufflevector(pair[1], pair[3], 2, 3, 10, 11, 6, 7, 14, 15);
    four[7] = __builtin_shufflevector(pair[5], pair[7], 2, 3, 10, 11, 6, 7, 14, 15);
    const auto low = [&](int k) __attribute__((always_inline)) {
        return __builtin_shufflevector(four[k], four[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    };
    const auto high = [&](int k) __attribute__((always_inline)) {
        return __builtin_shufflevector(four[k], four[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    };
    return {low(0), low(1), low(2), high(0), high(1), high(2), high(3)};
}

PALPATE_INLINE void add_product(const float (*M)[Skinning::width], const Eight3& v, Eight3& sum) {
    sum.x += eight(M[0]) * v.x + eight(M[1]) * v.y + eight(M[2]) * v.z;
    sum.y += eight(M[3]) * v.x + eight(M[4]) * v.y + eight(M[5]) * v.z;
    sum.z += eight(M[6]) * v.x + eight(M[7]) * v.y + eight(M[8]) * v.z;
}

constexpr int most_kept = 8;     // poses of a batch's spheres that are gathered once, not twice
constexpr int shares_ahead = 4;  // fetched before they are needed: the table is larger than the caches near the core

// p = x + R (c + sum_i A_i R^T (x_i - x) + 2 B_i vec(q^-1 q_i)), x and q the means.
PALPATE_CLONES void follow_all(const Skinning::Batch* batches, std::size_t n, const Skinning::Shares* all_shares,
                               const float* rows, float* positions) {
    for (std::size_t b = 0; b < n; ++b) {
        const Skinning::Batch& batch = batches[b];
        const Skinning::Shares* shares = all_shares + batch.first;
        Eight3 x{};
        Eight qx{}, qy{}, qz{}, qw{};
        EightPose first{}, kept[most_kept];
        for (int i = 0; i < batch.shares; ++i) {
            const char* ahead = reinterpret_cast<const char*>(shares + i + shares_ahead);
            for (std::size_t line = 0; line < sizeof(Skinning::Shares); line += 64) __builtin_prefetch(ahead + line);
            const EightPose p = poses_of(rows, shares[i].sphere);
            if (i == 0) first = p;
            if (i < most_kept) kept[i] = p;
            const Eight w = eight(shares[i].w);
            const Eight along = p.qx * first.qx + p.qy * first.qy + p.qz * first.qz + p.qw * first.qw;
            const Eight of_turn = along < 0 ? -w : w;
            x.x += w * p.x;
            x.y += w * p.y;
            x.z += w * p.z;
            qx += of_turn * p.qx;
            qy += of_turn * p.qy;
            qz += of_turn * p.qz;
            qw += of_turn * p.qw;
        }
        const Eight scale = 1 / root(qx * qx + qy * qy + qz * qz + qw * qw);
        qx *= scale;
        qy *= scale;
        qz *= scale;
        qw *= scale;
        const Eight r00 = 1 - 2 * (qy * qy + qz * qz), r01 = 2 * (qx * qy - qw * qz), r02 = 2 * (qx * qz + qw * qy);
        const Eight r10 = 2 * (qx * qy + qw * qz), r11 = 1 - 2 * (qx * qx + qz * qz), r12 = 2 * (qy * qz - qw * qx);
        const Eight r20 = 2 * (qx * qz - qw * qy), r21 = 2 * (qy * qz + qw * qx), r22 = 1 - 2 * (qx * qx + qy * qy);

        Eight3 sum{eight(batch.c[0]), eight(batch.c[1]), eight(batch.c[2])};
        for (int i = 0; i < batch.shares; ++i) {
            const EightPose p = i < most_kept ? kept[i] : poses_of(rows, shares[i].sphere);
            const Eight dx = p.x - x.x, dy = p.y - x.y, dz = p.z - x.z;
            add_product(
                shares[i].A,
                {r00 * dx + r10 * dy + r20 * dz, r01 * dx + r11 * dy + r21 * dz, r02 * dx + r12 * dy + r22 * dz}, sum);
            // the vector part of q^-1 q_i, of the shorter way round
            const Eight c = qw * p.qw + qx * p.qx + qy * p.qy + qz * p.qz;
            const Eight sign = c < 0 ? Eight{} - 1 : Eight{} + 1;
            add_product(shares[i].B,
                        {sign * (qw * p.qx - qx * p.qw - qy * p.qz + qz * p.qy),
                         sign * (qw * p.qy - qy * p.qw - qz * p.qx + qx * p.qz),
                         sign * (qw * p.qz - qz * p.qw - qx * p.qy + qy * p.qx)},
                        sum);
        }
        const Eight px = x.x + r00 * sum.x + r01 * sum.y + r02 * sum.z;
        const Eight py = x.y + r10 * sum.x + r11 * sum.y + r12 * sum.z;
        const Eight pz = x.z + r20 * sum.x + r21 * sum.y + r22 * sum.z;
        for (int i = 0; i < Skinning::width; ++i) {
            if (batch.vertex[i] < 0) continue;
            float* to = positions + 3L * batch.vertex[i];
            to[0] = px[i];
            to[1] = py[i];
            to[2] = pz[i];
        }
    }
}

}  // namespace

Skinning::Skinning(const skeleton::Model& model) : pose_(row_length * model.spheres.size()) {
    // Vertices with as many shares side by side; among these in their own order, as neighbours share spheres.
    std::vector<int> order(model.skin.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](int v) { return model.skin[v].shares.size(); });
    for (std::size_t begin = 0; begin < order.size(); begin += width) {
        const auto count = static_cast<int>(std::min<std::size_t>(width, order.size() - begin));
        Batch batch{};
        batch.first = static_cast<int>(shares_.size());
        batch.shares = static_cast<int>(model.skin[order[begin + count - 1]].shares.size());
        shares_.resize(shares_.size() + batch.shares, Shares{});
        for (int lane = 0; lane < width; ++lane) {
            const bool used = lane < count;
            const int vertex = order[begin + (used ? lane : 0)];
            batch.vertex[lane] = used ? vertex : -1;
            skeleton::Attachment point = model.skin[vertex];
            std::iter_swap(point.shares.begin(),
                           std::ranges::max_element(point.shares, {}, &skeleton::SphereInfluence::weight));
            Vec3 X = Vec3::Zero();
            for (const skeleton::SphereInfluence& share : point.shares)
                X += share.weight * model.spheres[share.sphere].center;
            const Vec3 arm = point.rest - X;
            Vec3 c = arm;
            for (int i = 0; i < batch.shares; ++i) {
                Shares& to = shares_[batch.first + i];
                to.sphere[lane] = point.shares.front().sphere;
                if (i >= static_cast<int>(point.shares.size())) continue;
                const skeleton::SphereInfluence& share = point.shares[i];
                const Mat3 A = share.follow.leftCols<3>() - share.weight * Mat3::Identity();
                const Mat3 B = 2 * (share.follow.rightCols<3>() + share.weight * skeleton::skew(arm));
                to.sphere[lane] = share.sphere;
                to.w[lane] = static_cast<float>(share.weight);
                for (int m = 0; m < 9; ++m) {
                    to.A[m][lane] = static_cast<float>(A(m / 3, m % 3));
                    to.B[m][lane] = static_cast<float>(B(m / 3, m % 3));
                }
                c -= A * (model.spheres[share.sphere].center - X);
            }
            for (int axis = 0; axis < 3; ++axis) batch.c[axis][lane] = static_cast<float>(c[axis]);
        }
        batches_.push_back(batch);
    }
}

void Skinning::follow(const double* pose, float* positions) {
    std::ranges::transform(pose, pose + pose_.size(), pose_.begin(), [](double a) { return static_cast<float>(a); });
    follow_all(batches_.data(), batches_.size(), shares_.data(), pose_.data(), positions);
}

}  // namespace palpate::runtime
