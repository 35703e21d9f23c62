#include "skeleton/lanes.h"
#include "skeleton/runtime/kernels/link_forces.h"

namespace palpate::runtime {

using namespace skeleton::lanewise;

namespace {

// The axes of a section as a half of the link carries them.
struct Axes {
    Lanes3 f0, f1, f2;
    Lanes3 of(Lanes a, Lanes b, Lanes c) const { return a * f0 + b * f1 + c * f2; }
};
PALPATE_INLINE Axes axes_of(const Lanes4& q) {
    const Lanes xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    const Lanes wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return {{1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)},
            {2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)},
            {2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)}};
}

PALPATE_INLINE Lanes4 rotation_of(const double* rows, const int* row) { return gathered(rows, row, row_length, 4); }
PALPATE_INLINE Lanes3 vector_of(const double* rows, const int* row, int offset) {
    return gathered(rows, row, row_length, offset).vector();
}

// Where the two halves of four links stand.
struct Halves {
    Lanes4 q_a, q_b;
    Axes a, b;
    Lanes3 arm_a, arm_b, gap;
};
PALPATE_INLINE Halves halves_of(const FullLinks& links, const double* pose) {
    Halves h;
    h.q_a = rotation_of(pose, links.a);
    h.q_b = rotation_of(pose, links.b);
    const Lanes4 q{at(links.q_section[0]), at(links.q_section[1]), at(links.q_section[2]), at(links.q_section[3])};
    h.a = axes_of(product(h.q_a, q));
    h.b = axes_of(product(h.q_b, q));
    h.arm_a = h.a.of(at(links.arm_a[0]), at(links.arm_a[1]), at(links.arm_a[2]));
    h.arm_b = h.b.of(at(links.arm_b[0]), at(links.arm_b[1]), at(links.arm_b[2]));
    h.gap = vector_of(pose, links.b, 0) - vector_of(pose, links.a, 0) + h.arm_b - h.arm_a;
    return h;
}

// How four links' ends move.
struct Motion {
    Lanes3 w_a, w_b, parting;  // the last of the halves' ends
};
PALPATE_INLINE Motion motion_of(const FullLinks& links, const Halves& h, const double* velocity) {
    Motion m;
    m.w_a = vector_of(velocity, links.a, 4);
    m.w_b = vector_of(velocity, links.b, 4);
    m.parting = vector_of(velocity, links.b, 0) - vector_of(velocity, links.a, 0) + cross(m.w_b, h.arm_b) -
                cross(m.w_a, h.arm_a);
    return m;
}

// A parting of the ends along the mean of the axis that the halves carry: (f_a + f_b) / 2 . gap.
PALPATE_INLINE Lanes parting(const Lanes3& f_a, const Lanes3& f_b, const Lanes3& gap) {
    return 0.5 * dot(f_a + f_b, gap);
}
PALPATE_INLINE Lanes parting_rate(const Lanes3& f_a, const Lanes3& f_b, const Lanes3& gap, const Motion& m) {
    return 0.5 * (dot(f_a + f_b, m.parting) + dot(cross(m.w_a, f_a) + cross(m.w_b, f_b), gap));
}

// C s in place: no strain depends on those before it.
PALPATE_INLINE void couple(const SectionCouplings& by, Lanes (&s)[6]) {
    int place = 0;
    for (int j = 0; j < 6; ++j)
        for (int i = j + 1; i < 6; ++i) s[j] += at(by.c[place++]) * s[i];
}
// C^T p in place, from the last on.
PALPATE_INLINE void couple_back(const SectionCouplings& by, Lanes (&p)[6]) {
    int place = 15;
    for (int j = 5; j >= 0; --j)
        for (int i = 5; i > j; --i) p[i] += at(by.c[--place]) * p[j];
}

// `by`: of coupled links.
template <bool damped, bool coupled>
PALPATE_INLINE Lanes add_batch(const FullLinks& links, const SectionCouplings* by, const double* pose,
                               const Rates& rates, const double* pressure, double* force) {
    const Halves h = halves_of(links, pose);
    const Lanes4 turn = upright(product(h.q_b, conjugate(h.q_a)));
    const Lanes3 v = turn.vector();

    // strains, in the order of Stiffness: elongation, flexion, torsion, flexion_2, shear, shear_2
    Lanes s[6] = {parting(h.a.f0, h.b.f0, h.gap),
                  2 * dot(v, h.a.f2),
                  2 * dot(v, h.a.f0),
                  2 * dot(v, h.a.f1),
                  parting(h.a.f1, h.b.f1, h.gap),
                  parting(h.a.f2, h.b.f2, h.gap)};
    for (int i = 0; i < 6; ++i) s[i] -= at(links.natural[i]);
    if constexpr (coupled) couple(*by, s);
    Lanes energy = all(0);
    for (int i = 0; i < 6; ++i) energy += at(links.k[i]) * s[i] * s[i];
    if constexpr (damped) {
        const Motion m = motion_of(links, h, rates.velocity);
        const Lanes3 w = m.w_b - m.w_a;
        const auto turning_rate = [&](const Lanes3& f) __attribute__((always_inline)) {
            return dot(turn.w * f + cross(v, f), w);
        };
        Lanes rate[6] = {parting_rate(h.a.f0, h.b.f0, h.gap, m),
                         turning_rate(h.a.f2),
                         turning_rate(h.a.f0),
                         turning_rate(h.a.f1),
                         parting_rate(h.a.f1, h.b.f1, h.gap, m),
                         parting_rate(h.a.f2, h.b.f2, h.gap, m)};
        if constexpr (coupled) couple(*by, rate);
        for (int i = 0; i < 6; ++i) s[i] += rates.beta * rate[i];
    }
    for (int i = 0; i < 6; ++i) s[i] *= at(links.k[i]);
    if constexpr (coupled) couple_back(*by, s);
    if (pressure) {
        Lanes both;
        for (int i = 0; i < lanes; ++i) both[i] = pressure[links.a[i]] + pressure[links.b[i]];
        s[0] += at(links.half_area) * both;
    }

    // All is linear in the axes: those of the partings together, and those of the turnings.
    const Lanes3 f_a = h.a.of(s[0], s[4], s[5]), f_b = h.b.of(s[0], s[4], s[5]);
    const Lanes3 mean = all(0.5) * (f_a + f_b);
    const Lanes3 F = h.a.of(s[2], s[3], s[1]);
    const Lanes3 couple = turn.w * F + cross(v, F);
    scatter_add(force, links.a, row_length, 0, mean);
    scatter_add(force, links.a, row_length, 4, couple + cross(h.arm_a, mean) - all(0.5) * cross(f_a, h.gap));
    scatter_add(force, links.b, row_length, 0, all(-1) * mean);
    scatter_add(force, links.b, row_length, 4,
                all(-1) * (couple + cross(h.arm_b, mean) + all(0.5) * cross(f_b, h.gap)));
    return 0.5 * energy;
}

template <bool damped>
PALPATE_INLINE void swell(const FullLinks& links, const double* pose, const Rates& rates, double* swelling) {
    const Halves h = halves_of(links, pose);
    Lanes s = parting(h.a.f0, h.b.f0, h.gap) - at(links.natural[0]);
    if constexpr (damped) {
        s += rates.beta * parting_rate(h.a.f0, h.b.f0, h.gap, motion_of(links, h, rates.velocity));
    }
    const Lanes by = at(links.half_area) * s;
    for (int i = 0; i < lanes; ++i) {
        swelling[links.a[i]] += by[i];
        swelling[links.b[i]] += by[i];
    }
}

PALPATE_CLONES double add_undamped(const FullLinks* links, std::size_t n, const double* pose, const double* pressure,
                                   double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i) energy += add_batch<false, false>(links[i], nullptr, pose, {}, pressure, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}
PALPATE_CLONES double add_damped(const FullLinks* links, std::size_t n, const double* pose, const Rates& rates,
                                 const double* pressure, double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i)
        energy += add_batch<true, false>(links[i], nullptr, pose, rates, pressure, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}
PALPATE_CLONES double add_coupled(const FullLinks* links, const SectionCouplings* by, std::size_t n, const double* pose,
                                  const double* pressure, double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i) energy += add_batch<false, true>(links[i], by + i, pose, {}, pressure, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}
PALPATE_CLONES double add_coupled_damped(const FullLinks* links, const SectionCouplings* by, std::size_t n,
                                         const double* pose, const Rates& rates, const double* pressure,
                                         double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i) energy += add_batch<true, true>(links[i], by + i, pose, rates, pressure, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}
PALPATE_CLONES void swell_undamped(const FullLinks* links, std::size_t n, const double* pose, double* swelling) {
    for (std::size_t i = 0; i < n; ++i) swell<false>(links[i], pose, {}, swelling);
}
PALPATE_CLONES void swell_damped(const FullLinks* links, std::size_t n, const double* pose, const Rates& rates,
                                 double* swelling) {
    for (std::size_t i = 0; i < n; ++i) swell<true>(links[i], pose, rates, swelling);
}

}  // namespace

double add_full_links(std::span<const FullLinks> links, std::span<const SectionCouplings> couplings, const double* pose,
                      const Rates& rates, const double* pressure, double* force) {
    const bool damped = rates.velocity && rates.beta > 0;
    if (!couplings.empty()) {
        const SectionCouplings* by = couplings.data();
        return damped ? add_coupled_damped(links.data(), by, links.size(), pose, rates, pressure, force)
                      : add_coupled(links.data(), by, links.size(), pose, pressure, force);
    }
    if (damped) return add_damped(links.data(), links.size(), pose, rates, pressure, force);
    return add_undamped(links.data(), links.size(), pose, pressure, force);
}

void add_swelling(std::span<const FullLinks> links, const double* pose, const Rates& rates, double* swelling) {
    if (rates.velocity && rates.beta > 0) {
        swell_damped(links.data(), links.size(), pose, rates, swelling);
    } else {
        swell_undamped(links.data(), links.size(), pose, swelling);
    }
}

}  // namespace palpate::runtime
