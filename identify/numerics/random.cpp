#include "identify/numerics/random.h"

#include <cmath>
#include <numbers>

namespace palpate::identify {
namespace {

constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15U;

std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t step, std::uint64_t item)
    : state_(mix(mix(mix(seed + golden_gamma) + step + golden_gamma) + item + golden_gamma)) {}

std::uint64_t RandomStream::next() { return mix(state_ += golden_gamma); }

double RandomStream::uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

double RandomStream::normal() {
    // Box-Muller; 1 - u lies in (0, 1]
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
}

Eigen::VectorXd RandomStream::normals(int n) {
    Eigen::VectorXd z(n);
    for (double& value : z) value = normal();
    return z;
}

}  // namespace palpate::identify
