#include "skeleton/lanes.h"
#include "skeleton/runtime/kernels/link_forces.h"

namespace palpate::runtime {

using namespace skeleton::lanewise;

namespace {

// theta / sin theta by the cosine, for angles up to 45 degrees: a polynomial in x = 1 - cos theta that meets the series
// 1 + x / 3 + 2 x^2 / 15 + ... at 12 Chebyshev points of [0, 1 - sqrt(1/2)]; it is off by 1e-17 at most.
PALPATE_INLINE Lanes angle_by_sine(Lanes cosine) {
    const Lanes x = 1 - cosine;
    Lanes P = all(0.0003084014958506886);
    P = P * x + 0.00010080899591663528;
    P = P * x + 0.0006318651834244942;
    P = P * x + 0.0011473483248567273;
    P = P * x + 0.0024907294711391964;
    P = P * x + 0.005327460608160428;
    P = P * x + 0.011544056421195333;
    P = P * x + 0.025396823062726764;
    P = P * x + 0.057142857214258436;
    P = P * x + 0.1333333333322078;
    P = P * x + 0.33333333333334025;
    return P * x + 1.0;
}

// 1/2 theta^2 at an end: theta^2, and the slope of the half of it by cos theta, -theta / sin theta, which is smooth at
// theta = 0.
struct Bend {
    Lanes square, slope;
};
template <bool small>
PALPATE_INLINE Bend bend(Lanes square_of_sine, Lanes cosine) {
    if constexpr (small) {
        const Lanes by_sine = angle_by_sine(cosine);
        return {by_sine * by_sine * square_of_sine, -by_sine};
    }
    const Lanes sine = root(square_of_sine), theta = angle(larger(sine, all(1e-300)), cosine);
    const LaneMask straight = (cosine > 0) & (sine < 1e-9);
    return {theta * theta, pick(straight, all(-1), -theta / larger(sine, all(1e-9)))};
}

// The twist tau = 2 atan2(s, w), and 1 / rho.
struct Twist {
    Lanes tau, inverse_rho;
};
template <bool small>
PALPATE_INLINE Twist twist_of(Lanes s, Lanes w) {
    const Lanes rho = s * s + w * w;
    if constexpr (small) {
        const Lanes inverse = 1 / (rho * w), u = s * rho * inverse;
        return {2 * small_angle(u), w * inverse};
    }
    const Lanes half = angle(magnitude(s), larger(w, all(1e-300)));
    return {pick(s < 0, -2 * half, 2 * half), 1 / larger(rho, all(1e-24))};
}

// Forces of four links, as derivatives of their energy by x_b, w_a and w_b.
struct Gradient {
    Lanes3 by_x, by_a, by_b;
};

PALPATE_INLINE void add_damping(const PaperLinks& links, const Lanes3& n, Lanes inverse_length, const Rates& rates,
                                Gradient& g) {
    const auto part = [&](const int* row, int offset) __attribute__((always_inline)) {
        return gathered(rates.velocity, row, row_length, offset).vector();
    };
    const Lanes3 parting = part(links.b, 0) - part(links.a, 0);
    const Lanes3 w_a = part(links.a, 4), w_b = part(links.b, 4);
    // how each end turns against the link, across it
    const Lanes3 swing = inverse_length * cross(n, parting);
    const Lanes3 r_a = w_a - dot(n, w_a) * n - swing, r_b = w_b - dot(n, w_b) * n - swing;
    const Lanes cE = rates.beta * at(links.kE), cF = rates.beta * at(links.kF), cT = rates.beta * at(links.kT);
    const Lanes3 twist = (cT * dot(n, w_b - w_a)) * n;
    g.by_x = g.by_x + (cE * dot(n, parting)) * n + (cF * inverse_length) * cross(n, r_a + r_b);
    g.by_a = g.by_a + cF * r_a - twist;
    g.by_b = g.by_b + cF * r_b + twist;
}

// Four links as they stand.
struct Stand {
    Lanes l, inverse_length;
    Lanes3 n, d_a, d_b, turn_a, turn_b;  // d: carried directions; turn: d x n
    Lanes c_a, c_b;                      // d . n
    Lanes4 p;                            // R_b R_a^T
    Lanes s;                             // of its vector along d_a
};
PALPATE_INLINE Stand stand(const PaperLinks& links, const double* pose) {
    const Lanes3 x = gathered(pose, links.b, row_length, 0).vector() - gathered(pose, links.a, row_length, 0).vector();
    const Lanes4 q_a = gathered(pose, links.a, row_length, 4), q_b = gathered(pose, links.b, row_length, 4);
    const Lanes3 d0{at(links.d0[0]), at(links.d0[1]), at(links.d0[2])};
    Stand t;
    t.l = root(dot(x, x));
    t.inverse_length = 1 / t.l;
    t.n = t.inverse_length * x;
    t.d_a = turned(q_a, d0);
    t.d_b = turned(q_b, d0);
    t.turn_a = cross(t.d_a, t.n);
    t.turn_b = cross(t.d_b, t.n);
    t.c_a = dot(t.d_a, t.n);
    t.c_b = dot(t.d_b, t.n);
    t.p = upright(product(q_b, conjugate(q_a)));
    t.s = dot(t.p.vector(), t.d_a);
    return t;
}

// Are all bent and twisted by less than 45 degrees an end?
PALPATE_INLINE bool is_small(const Stand& t) {
    const LaneMask large = (smaller(t.c_a, t.c_b) < 0.70711) | (magnitude(t.s) > 0.41421 * t.p.w);
    return (large[0] | large[1] | large[2] | large[3]) == 0;
}

template <bool small, bool damped>
PALPATE_INLINE Lanes add_stand(const PaperLinks& links, const Stand& t, const Rates& rates, double* force) {
    const Lanes kE = at(links.kE), kF = at(links.kF), kT = at(links.kT);

    // elongation 1/2 (l - L)^2
    const Lanes stretch = t.l - at(links.length);
    Lanes energy = kE * stretch * stretch;
    Gradient g;
    g.by_x = (kE * stretch) * t.n;

    // flexion 1/2 theta^2 at each end: with c = n . d, dc = (d - c n) / l . dx + (d x n) . w
    const Bend at_a = bend<small>(dot(t.turn_a, t.turn_a), t.c_a), at_b = bend<small>(dot(t.turn_b, t.turn_b), t.c_b);
    energy += kF * (at_a.square + at_b.square);
    const Lanes3 pull = at_a.slope * (t.d_a - t.c_a * t.n) + at_b.slope * (t.d_b - t.c_b * t.n);
    g.by_x = g.by_x + (kF * t.inverse_length) * pull;
    g.by_a = (kF * at_a.slope) * t.turn_a;
    g.by_b = (kF * at_b.slope) * t.turn_b;

    // torsion 1/2 tau^2, tau = 2 atan2(s, w), s = v . d_a for R_b R_a^T = (w, v): dtau = h . (w_b - w_a)
    const Twist at_ends = twist_of<small>(t.s, t.p.w);
    energy += kT * at_ends.tau * at_ends.tau;
    const Lanes3 v = t.p.vector(), y = t.p.w * t.d_a + cross(v, t.d_a);
    const Lanes3 twist = (kT * at_ends.tau * at_ends.inverse_rho) * (t.p.w * y + t.s * v);
    g.by_a = g.by_a - twist;
    g.by_b = g.by_b + twist;

    if constexpr (damped) add_damping(links, t.n, t.inverse_length, rates, g);
    const Lanes3 nothing{all(0), all(0), all(0)};
    scatter_add(force, links.a, row_length, 0, g.by_x);
    scatter_add(force, links.a, row_length, 4, nothing - g.by_a);
    scatter_add(force, links.b, row_length, 0, nothing - g.by_x);
    scatter_add(force, links.b, row_length, 4, nothing - g.by_b);
    return 0.5 * energy;
}

template <bool damped>
PALPATE_INLINE Lanes add_batch(const PaperLinks& links, const double* pose, const Rates& rates, double* force) {
    const Stand t = stand(links, pose);
    if (is_small(t)) return add_stand<true, damped>(links, t, rates, force);
    return add_stand<false, damped>(links, t, rates, force);
}

PALPATE_CLONES double add_undamped(const PaperLinks* links, std::size_t n, const double* pose, double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i) energy += add_batch<false>(links[i], pose, {}, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}

PALPATE_CLONES double add_damped(const PaperLinks* links, std::size_t n, const double* pose, const Rates& rates,
                                 double* force) {
    Lanes energy = all(0);
    for (std::size_t i = 0; i < n; ++i) energy += add_batch<true>(links[i], pose, rates, force);
    return energy[0] + energy[1] + energy[2] + energy[3];
}

}  // namespace

double add_paper_links(std::span<const PaperLinks> links, const double* pose, const Rates& rates, double* force) {
    if (rates.velocity && rates.beta > 0) return add_damped(links.data(), links.size(), pose, rates, force);
    return add_undamped(links.data(), links.size(), pose, force);
}

}  // namespace palpate::runtime
