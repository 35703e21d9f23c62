#include "skeleton/runtime/kernels/motion.h"

#include "skeleton/lanes.h"

namespace palpate::runtime {

using namespace skeleton::lanewise;

namespace {

PALPATE_INLINE Lanes4 row_of_four(const double* rows, int offset) {
    const double* p = rows + offset;
    return transposed(at(p), at(p + row_length), at(p + 2 * row_length), at(p + 3 * row_length));
}
PALPATE_INLINE void put_rows(const Lanes4& v, double* rows, int offset) {
    const Lanes4 of = transposed(v.x, v.y, v.z, v.w);
    double* p = rows + offset;
    put(p, of.x);
    put(p + row_length, of.y);
    put(p + 2 * row_length, of.z);
    put(p + 3 * row_length, of.w);
}

// A turn about one axis of the body by 2 atan t, t = h L / (2 I): the orientation q turns by (t e, 1), of another
// length then, and the momentum, as the body sees it, the other way; `next` and `last` are its parts along the two axes
// that follow.
PALPATE_INLINE void turn(Lanes t, Lanes& q_axis, Lanes& q_next, Lanes& q_last, Lanes& q_w, Lanes& next, Lanes& last) {
    const Lanes x = q_axis, y = q_next, z = q_last, w = q_w;
    q_axis = x + t * w;
    q_next = y + t * z;
    q_last = z - t * y;
    q_w = w - t * x;
    const Lanes square = t * t, inverse = 1 / (1 + square);
    const Lanes cosine = (1 - square) * inverse, sine = 2 * t * inverse;
    const Lanes turned_next = cosine * next + sine * last;
    last = cosine * last - sine * next;
    next = turned_next;
}

// Forces over a time, and the share of momenta that drag leaves.
struct Kick {
    double time = 0, kept = 1;
    const double* force = nullptr;
};
// Of four spheres the rows of momenta, from `offset` on.
template <bool kicked>
PALPATE_INLINE void momenta_after(const Kick& kick, int offset, double* momentum, Lanes (&row)[lanes]) {
    for (int i = 0; i < lanes; ++i) {
        double* p = momentum + i * row_length + offset;
        row[i] = at(p);
        if constexpr (kicked) {
            row[i] = kick.kept * (row[i] + kick.time * at(kick.force + i * row_length + offset));
            put(p, row[i]);
        }
    }
}

template <bool kicked>
PALPATE_INLINE void move_four(const Masses& m, Kick kick, double h, double* momentum, double* pose) {
    Lanes p[lanes], L[lanes];
    momenta_after<kicked>(kick, 0, momentum, p);
    momenta_after<kicked>(kick, 4, momentum, L);
    for (int i = 0; i < lanes; ++i) {
        double* x = pose + i * row_length;
        put(x, at(x) + h * m.inverse_mass[i] * p[i]);
    }
    const Lanes4 axes{at(m.q_axes[0]), at(m.q_axes[1]), at(m.q_axes[2]), at(m.q_axes[3])};
    Lanes4 q = product(row_of_four(pose, 4), axes);
    const Lanes3 l = turned(conjugate(q), transposed(L[0], L[1], L[2], L[3]).vector());
    Lanes l0 = l.x, l1 = l.y, l2 = l.z;
    const Lanes i0 = 0.25 * h * at(m.inverse_inertia[0]), i1 = 0.25 * h * at(m.inverse_inertia[1]);
    const Lanes i2 = 0.5 * h * at(m.inverse_inertia[2]);
    turn(i0 * l0, q.x, q.y, q.z, q.w, l1, l2);
    turn(i1 * l1, q.y, q.z, q.x, q.w, l2, l0);
    turn(i2 * l2, q.z, q.x, q.y, q.w, l0, l1);
    turn(i1 * l1, q.y, q.z, q.x, q.w, l2, l0);
    turn(i0 * l0, q.x, q.y, q.z, q.w, l1, l2);
    q = product(q, conjugate(axes));
    const Lanes scale = 1 / root(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    put_rows({scale * q.x, scale * q.y, scale * q.z, scale * q.w}, pose, 4);
}

constexpr long stride = static_cast<long>(lanes) * row_length;

PALPATE_CLONES void drift_all(const Masses* masses, std::size_t n, double h, double* momentum, double* pose) {
    for (std::size_t i = 0; i < n; ++i, momentum += stride, pose += stride)
        move_four<false>(masses[i], {}, h, momentum, pose);
}

PALPATE_CLONES void kick_and_drift_all(const Masses* masses, std::size_t n, Kick kick, double h, double* momentum,
                                       double* pose) {
    for (std::size_t i = 0; i < n; ++i, momentum += stride, pose += stride, kick.force += stride)
        move_four<true>(masses[i], kick, h, momentum, pose);
}

PALPATE_CLONES double all_velocities(const Masses* masses, std::size_t n, const double* momentum, const double* pose,
                                     double* velocity) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i, momentum += stride, pose += stride, velocity += stride) {
        const Masses& m = masses[i];
        const Lanes3 p = row_of_four(momentum, 0).vector(), L = row_of_four(momentum, 4).vector();
        const Lanes3 v = at(m.inverse_mass) * p;
        const Lanes4 axes{at(m.q_axes[0]), at(m.q_axes[1]), at(m.q_axes[2]), at(m.q_axes[3])};
        const Lanes4 q = product(row_of_four(pose, 4), axes);
        const Lanes3 own = turned(conjugate(q), L);
        const Lanes3 w = turned(
            q, {at(m.inverse_inertia[0]) * own.x, at(m.inverse_inertia[1]) * own.y, at(m.inverse_inertia[2]) * own.z});
        put_rows({v.x, v.y, v.z, all(0)}, velocity, 0);
        put_rows({w.x, w.y, w.z, all(0)}, velocity, 4);
        energy += 0.5 * (dot(p, v) + dot(L, w));
    }
    return energy[0] + energy[1] + energy[2] + energy[3];
}

}  // namespace

void drift(std::span<const Masses> masses, double h, double* momentum, double* pose) {
    drift_all(masses.data(), masses.size(), h, momentum, pose);
}

void kick_and_drift(std::span<const Masses> masses, double time, double kept, const double* force, double h,
                    double* momentum, double* pose) {
    kick_and_drift_all(masses.data(), masses.size(), {time, kept, force}, h, momentum, pose);
}

double velocities(std::span<const Masses> masses, const double* momentum, const double* pose, double* velocity) {
    return all_velocities(masses.data(), masses.size(), momentum, pose, velocity);
}

}  // namespace palpate::runtime
