#include "diagnosis/located.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace palpate::bench {
namespace {

using identify::SourceKind;
using identify::SourceLaw;

SourceKind kind_of(const std::string& effect) {
    static const std::set<std::string> forces{"gravity", "prestress", "swelling"};
    static const std::set<std::string> boundary{"contact", "pressure", "compliant-support", "friction"};
    static const std::set<std::string> sensor{"misalignment", "outliers",       "force-gain",
                                              "slip",         "actuation-gain", "clock"};
    if (forces.contains(effect)) return SourceKind::body_force;
    if (boundary.contains(effect)) return SourceKind::boundary;
    return sensor.contains(effect) ? SourceKind::sensor : SourceKind::stiffness;
}

/// How an effect goes with what acts; faults of single readings and probes go with nothing.
std::set<SourceLaw> laws_of(const std::string& effect) {
    static const std::map<std::string, std::set<SourceLaw>> laws{
        {"gravity", {SourceLaw::constant}},
        {"prestress", {SourceLaw::constant}},
        {"swelling", {SourceLaw::constant}},
        {"misalignment", {SourceLaw::constant}},
        {"inclusion", {SourceLaw::constant}},
        {"anisotropy", {SourceLaw::constant}},
        {"stiffening", {SourceLaw::proportional, SourceLaw::quadratic, SourceLaw::with_strain}},
        {"viscosity", {SourceLaw::with_time}},
        {"plasticity", {SourceLaw::with_history}},
        {"contact", {SourceLaw::one_sided}},
        {"compliant-support", {SourceLaw::reaction}},
    };
    const auto found = laws.find(effect);
    return found == laws.end() ? std::set<SourceLaw>{} : found->second;
}

std::optional<Vec3> numbers(const Truth& truth, const std::string& effect, const std::array<const char*, 3>& names) {
    Vec3 result;
    for (int a = 0; a < 3; ++a) {
        const auto found = truth.numbers.find(effect + " " + names[static_cast<std::size_t>(a)]);
        if (found == truth.numbers.end()) return {};
        result[a] = found->second;
    }
    return result;
}

double degrees_between(const Vec3& a, const Vec3& b) {
    return 180 / std::numbers::pi * std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

constexpr double near_share = 0.15, near_degrees = 20;  // what the aim counts as right

}  // namespace

Located judge_location(const Truth& truth, const identify::MissingSource& source, double size) {
    Located result;
    const auto found =
        std::ranges::find_if(truth.effects, [&](const std::string& effect) { return kind_of(effect) == source.kind; });
    if (found == truth.effects.end()) return result;
    const std::string& effect = *found;
    const identify::SourceTerm& term = source.likeliest();
    result.kind = true;
    if (const std::set<SourceLaw> laws = laws_of(effect); !laws.empty()) result.law = laws.contains(term.law);
    if (const auto centre = numbers(truth, effect, {"cx", "cy", "cz"})) {
        result.place_mm = (source.at - *centre).norm();
        result.place_share = *result.place_mm / size;
    }
    if (const auto force = numbers(truth, effect, {"gx", "gy", "gz"}); force && source.direction.norm() > 0)
        result.angle = degrees_between(source.direction, *force);
    if (const auto normal = numbers(truth, effect, {"nx", "ny", "nz"})) {
        // Fibres have no sign, and neither does a wall's normal, which may be told from either side.
        const Vec3 axis = effect == "anisotropy" ? term.axis : source.direction;
        if (axis.norm() > 0) {
            const double angle = degrees_between(axis, *normal);
            result.angle = std::min(angle, 180 - angle);
        }
    }
    return result;
}

void LocatedTally::add(const Truth& truth, const std::optional<identify::MissingSource>& source, double size) {
    if (truth.effects.empty()) {
        nulls_.add(source && source->log_bayes_factor() > 0);
        return;
    }
    const Located found = source ? judge_location(truth, *source, size) : Located{};
    kind_.add(found.kind);
    if (found.law) law_.add(*found.law);
    if (found.place_share) place_.add(*found.place_share <= near_share);
    if (found.angle) direction_.add(*found.angle <= near_degrees);
}

void LocatedTally::add_held_out(const Truth& truth, double before, double after) {
    constexpr double halved = 0.5;  // of what noise does not explain
    const auto excess = [](double whitened) { return std::sqrt(std::max(0.0, whitened * whitened - 1)); };
    if (!truth.effects.empty()) held_out_.add(std::isfinite(after) && excess(after) <= halved * excess(before));
}

void LocatedTally::add(const LocatedTally& more) {
    kind_.add(more.kind_);
    law_.add(more.law_);
    place_.add(more.place_);
    direction_.add(more.direction_);
    held_out_.add(more.held_out_);
    nulls_.add(more.nulls_);
}

void LocatedTally::print() const {
    fmt::print(
        "\nKind right in {} of {}; of these the law in {} of {}, the place within {:.0f} % of the size in {} of {}, "
        "the "
        "direction within {:.0f} degrees in {} of {}. Something is located in {} of {} null sets.\n",
        kind_.right, kind_.of, law_.right, law_.of, 100 * near_share, place_.right, place_.of, near_degrees,
        direction_.right, direction_.of, nulls_.right, nulls_.of);
    if (held_out_.of > 0) {
        fmt::print("Errors of held-out probes beyond the noise are at least halved in {} of {}.\n", held_out_.right,
                   held_out_.of);
    }
}

}  // namespace palpate::bench
