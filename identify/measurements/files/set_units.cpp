#include "identify/measurements/files/set_units.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace palpate::identify {
namespace {

/// What the unit that `given` chooses is in ours.
double unit_factor(const mesh::YamlFields& given, const std::string& key,
                   const std::vector<std::pair<std::string, double>>& units, double otherwise) {
    if (!given.has(key)) return otherwise;
    std::vector<std::string> names;
    names.reserve(units.size());
    for (const auto& unit : units) names.push_back(unit.first);
    const std::string chosen = given.choice(key, names);
    return std::ranges::find(units, chosen, &std::pair<std::string, double>::first)->second;
}

}  // namespace

SetUnits read_units(const mesh::YamlFields& set) {
    constexpr double degree = std::numbers::pi / 180;
    constexpr double mmhg = 101325e-6 / 760;  // [MPa]: the torr, by definition
    SetUnits units;
    if (!set.has("units")) return units;
    const mesh::YamlFields given = set.mapping("units");
    if (given.has("length")) units.length_name = given.text("length");
    if (given.has("force")) units.force_name = given.text("force");
    units.length = unit_factor(given, "length", {{"mm", 1}, {"cm", 10}, {"m", 1000}}, units.length);
    units.force = unit_factor(given, "force", {{"N", 1}, {"mN", 1e-3}}, units.force);
    if (given.has("time")) given.choice("time", {"s"});
    units.angle = unit_factor(given, "angle", {{"deg", degree}, {"rad", 1}}, units.angle);
    units.pressure = unit_factor(
        given, "pressure", {{"kPa", 1e-3}, {"MPa", 1}, {"Pa", 1e-6}, {"mbar", 1e-4}, {"bar", 0.1}, {"mmHg", mmhg}},
        units.pressure);
    units.moment = unit_factor(given, "moment", {{"N*mm", 1}, {"N*m", 1000}}, units.force * units.length);
    given.finish();
    return units;
}

}  // namespace palpate::identify
