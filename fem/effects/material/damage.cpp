#include "fem/effects/material/damage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::fem {

namespace {

using std::numbers::inv_sqrtpi;

double scale(const Damage& damage) { return 1.5 * damage.strain * damage.strain; }

double integral_of_erf(double x) { return x * std::erf(x) + std::expm1(-x * x) * inv_sqrtpi; }

}  // namespace

DamageTerms damage_energy(const Damage& damage, double most, double D) {
    const double m = scale(damage), x = std::max(0.0, most - D) / m;
    DamageTerms terms;
    terms.energy = -damage.share * m * (integral_of_erf(most / m) - integral_of_erf(x));
    terms.first = -damage.share * std::erf(x);
    if (x > 0) terms.second = damage.share / m * 2 * inv_sqrtpi * std::exp(-x * x);
    return terms;
}

}  // namespace palpate::fem
