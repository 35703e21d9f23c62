#include "skeleton/links/fibres/plastic_fibre.h"

#include <cmath>

namespace palpate::skeleton {

namespace {

// |e_p - e_p0|: the stress |e - e_p| comes down to y + h a.
double flowed(const fem::Plasticity& plasticity, const FibreState& before, double lambda) {
    const double beyond =
        std::abs(lambda - 1 - before.strain) - plasticity.yield - plasticity.hardening * before.accumulated;
    return beyond > 0 ? beyond / (1 + plasticity.hardening) : 0;
}

}  // namespace

FibreState flow(const fem::Plasticity& plasticity, const FibreState& before, double lambda) {
    const double more = flowed(plasticity, before, lambda);
    return {before.strain + std::copysign(more, lambda - 1 - before.strain), before.accumulated + more, before.most};
}

Eigen::Matrix<double, 2, 3> flow_derivatives(const fem::Plasticity& plasticity, const FibreState& before,
                                             double lambda) {
    Eigen::Matrix<double, 2, 3> slopes;
    slopes << 0, 1, 0, 0, 0, 1;
    if (flowed(plasticity, before, lambda) > 0) {
        const double sign = std::copysign(1.0, lambda - 1 - before.strain);
        const Eigen::RowVector3d more =
            Eigen::RowVector3d(sign, -sign, -plasticity.hardening) / (1 + plasticity.hardening);
        slopes.row(0) += sign * more;
        slopes.row(1) += more;
    }
    return slopes;
}

StretchTerms plastic_terms(const fem::Plasticity& plasticity, const FibreState& before, double lambda) {
    const double more = flowed(plasticity, before, lambda);
    const FibreState now = flow(plasticity, before, lambda);
    // 1/2 (e - e_p)^2 - 1/2 e^2 = e_p (e_p / 2 - e)
    const double hardened = plasticity.yield + plasticity.hardening * (before.accumulated + 0.5 * more);
    return {now.strain * (0.5 * now.strain - (lambda - 1)) + more * hardened, -now.strain,
            more > 0 ? -1 / (1 + plasticity.hardening) : 0};
}

}  // namespace palpate::skeleton
