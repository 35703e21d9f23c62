#include "fem/effects/material/inclusion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "mesh/errors.h"

namespace palpate::fem {

Inclusion::Inclusion(Shape shape, const Vec3& centre, const Vec3& half_widths, double ratio)
    : shape_(shape), centre_(centre), half_widths_(half_widths), log_ratio_(std::log(ratio)) {
    assert(ratio > 0 && half_widths.minCoeff() > 0);
}

Inclusion Inclusion::sphere(const Vec3& centre, double radius, double ratio) {
    return {Shape::sphere, centre, Vec3::Constant(radius), ratio};
}

Inclusion Inclusion::box(const Vec3& centre, const Vec3& half_widths, double ratio) {
    return {Shape::box, centre, half_widths, ratio};
}

double Inclusion::stiffness(const Vec3& X) const {
    const Vec3 off = (X - centre_).cwiseQuotient(half_widths_);
    const double d = shape_ == Shape::sphere ? off.norm() : off.cwiseAbs().maxCoeff();
    // The border is half outside and half inside of the edge: wide enough for answers to follow the place, narrow
    // enough for the half widths to tell the size. What blind sets and diagnoses mean by an inclusion rests on it.
    constexpr double outer = 1.15, width = 0.3;
    return std::exp(log_ratio_ * std::clamp((outer - d) / width, 0.0, 1.0));
}

KnownEffect known_inclusion() {
    constexpr Range positive = Range::positive;
    return {"inclusion",
            {{"cx", "mm"},
             {"cy", "mm"},
             {"cz", "mm"},
             optional_parameter("radius", "mm", positive),
             optional_parameter("hx", "mm", positive),
             optional_parameter("hy", "mm", positive),
             optional_parameter("hz", "mm", positive),
             {"ratio", "1", positive}},
            [](const EffectNumbers& numbers) -> Effects {
                const Vec3 centre = numbers.vector("cx", "cy", "cz");
                int sides = 0;
                for (const char* name : {"hx", "hy", "hz"}) sides += numbers.has(name) ? 1 : 0;
                if (numbers.has("radius") ? sides != 0 : sides != 3)
                    throw InvalidInput("either a radius [mm] is needed, for a ball, or hx, hy and hz [mm], for a box");
                return {.material = {std::make_shared<Inclusion>(
                            numbers.has("radius")
                                ? Inclusion::sphere(centre, numbers["radius"], numbers["ratio"])
                                : Inclusion::box(centre, numbers.vector("hx", "hy", "hz"), numbers["ratio"]))}};
            }};
}

}  // namespace palpate::fem
