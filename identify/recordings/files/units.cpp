#include "identify/recordings/files/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double pound = 4.4482216152605;  // [N], by definition
constexpr double kilopond = 9.80665;       // [N], likewise
constexpr double inch = 25.4;              // [mm]
constexpr double torr = 101325e-6 / 760;   // [MPa]
constexpr double degree = std::numbers::pi / 180;

/// By their spelling without blanks and signs of multiplication; those in lower case are found in any case.
const std::map<std::string, UnitInOurs, std::less<>>& known_units() {
    static const std::map<std::string, UnitInOurs, std::less<>> units{{"mm", {"mm", 1}},
                                                                      {"millimeter", {"mm", 1}},
                                                                      {"millimeters", {"mm", 1}},
                                                                      {"millimetre", {"mm", 1}},
                                                                      {"millimetres", {"mm", 1}},
                                                                      {"cm", {"mm", 10}},
                                                                      {"centimeter", {"mm", 10}},
                                                                      {"centimeters", {"mm", 10}},
                                                                      {"centimetres", {"mm", 10}},
                                                                      {"dm", {"mm", 100}},
                                                                      {"m", {"mm", 1000}},
                                                                      {"meter", {"mm", 1000}},
                                                                      {"meters", {"mm", 1000}},
                                                                      {"metre", {"mm", 1000}},
                                                                      {"metres", {"mm", 1000}},
                                                                      {"um", {"mm", 1e-3}},
                                                                      {"\xC2\xB5m", {"mm", 1e-3}},
                                                                      {"\xCE\xBCm", {"mm", 1e-3}},
                                                                      {"micron", {"mm", 1e-3}},
                                                                      {"microns", {"mm", 1e-3}},
                                                                      {"micrometer", {"mm", 1e-3}},
                                                                      {"in", {"mm", inch}},
                                                                      {"inch", {"mm", inch}},
                                                                      {"inches", {"mm", inch}},
                                                                      {"ft", {"mm", 12 * inch}},
                                                                      {"feet", {"mm", 12 * inch}},
                                                                      {"N", {"N", 1}},
                                                                      {"newton", {"N", 1}},
                                                                      {"newtons", {"N", 1}},
                                                                      {"kN", {"N", 1000}},
                                                                      {"KN", {"N", 1000}},
                                                                      {"MN", {"N", 1e6}},
                                                                      {"mN", {"N", 1e-3}},
                                                                      {"uN", {"N", 1e-6}},
                                                                      {"\xC2\xB5N", {"N", 1e-6}},
                                                                      {"\xCE\xBCN", {"N", 1e-6}},
                                                                      {"cN", {"N", 1e-2}},
                                                                      {"lbf", {"N", pound}},
                                                                      {"lbs", {"N", pound}},
                                                                      {"kgf", {"N", kilopond}},
                                                                      {"gf", {"N", kilopond * 1e-3}},
                                                                      {"kp", {"N", kilopond}},
                                                                      {"Nmm", {"N*mm", 1}},
                                                                      {"Nm", {"N*mm", 1000}},
                                                                      {"mNm", {"N*mm", 1}},
                                                                      {"mNmm", {"N*mm", 1e-3}},
                                                                      {"kNm", {"N*mm", 1e6}},
                                                                      {"Ncm", {"N*mm", 10}},
                                                                      {"kNmm", {"N*mm", 1000}},
                                                                      {"MPa", {"MPa", 1}},
                                                                      {"MPA", {"MPa", 1}},
                                                                      {"Mpa", {"MPa", 1}},
                                                                      {"kPa", {"MPa", 1e-3}},
                                                                      {"Pa", {"MPa", 1e-6}},
                                                                      {"hPa", {"MPa", 1e-4}},
                                                                      {"GPa", {"MPa", 1e3}},
                                                                      {"bar", {"MPa", 0.1}},
                                                                      {"mbar", {"MPa", 1e-4}},
                                                                      {"psi", {"MPa", pound / (inch * inch)}},
                                                                      {"mmHg", {"MPa", torr}},
                                                                      {"N/mm2", {"MPa", 1}},
                                                                      {"N/mm^2", {"MPa", 1}},
                                                                      {"N/mm\xC2\xB2", {"MPa", 1}},
                                                                      {"N/m2", {"MPa", 1e-6}},
                                                                      {"N/m^2", {"MPa", 1e-6}},
                                                                      {"N/m\xC2\xB2", {"MPa", 1e-6}},
                                                                      {"s", {"s", 1}},
                                                                      {"sec", {"s", 1}},
                                                                      {"secs", {"s", 1}},
                                                                      {"second", {"s", 1}},
                                                                      {"seconds", {"s", 1}},
                                                                      {"sek", {"s", 1}},
                                                                      {"ms", {"s", 1e-3}},
                                                                      {"msec", {"s", 1e-3}},
                                                                      {"milliseconds", {"s", 1e-3}},
                                                                      {"us", {"s", 1e-6}},
                                                                      {"\xC2\xB5s", {"s", 1e-6}},
                                                                      {"\xCE\xBCs", {"s", 1e-6}},
                                                                      {"ns", {"s", 1e-9}},
                                                                      {"min", {"s", 60}},
                                                                      {"minutes", {"s", 60}},
                                                                      {"h", {"s", 3600}},
                                                                      {"hours", {"s", 3600}},
                                                                      {"rad", {"rad", 1}},
                                                                      {"radians", {"rad", 1}},
                                                                      {"deg", {"rad", degree}},
                                                                      {"degree", {"rad", degree}},
                                                                      {"degrees", {"rad", degree}},
                                                                      {"\xC2\xB0", {"rad", degree}}};
    return units;
}

std::string spelled_alike(std::string_view unit) {
    std::string result;
    for (std::size_t i = 0; i < unit.size(); ++i) {
        const bool is_middle_dot = unit.substr(i).starts_with("\xC2\xB7");
        const bool is_sign = unit[i] == ' ' || unit[i] == '*' || unit[i] == '.' || unit[i] == '-';
        if (is_middle_dot) ++i;
        if (!is_middle_dot && !is_sign) result += unit[i];
    }
    return result;
}

bool is_bracketed(std::string_view cell) {
    return cell.size() >= 2 &&
           ((cell.front() == '(' && cell.back() == ')') || (cell.front() == '[' && cell.back() == ']'));
}

/// Units that stand after a '_' or a '/' in names: longer words only, or those that begin no other words.
bool is_plain_suffix(std::string_view unit) {
    static const std::vector<std::string> suffixes{"mm", "cm", "N",   "kN",  "mN",  "MPa", "kPa", "bar", "mbar",
                                                   "ms", "us", "deg", "rad", "Nmm", "Nm",  "sec", "psi", "um"};
    return std::ranges::find(suffixes, unit) != suffixes.end();
}

}  // namespace

std::optional<UnitInOurs> unit_in_ours(std::string_view unit) {
    constexpr std::size_t longest = 20;
    unit = trimmed(unit);
    if (unit.empty() || unit.size() > longest) return std::nullopt;
    const std::string spelled = spelled_alike(unit);
    const auto& units = known_units();
    if (const auto found = units.find(spelled); found != units.end()) return found->second;
    // "SEC", "MM" and "Seconds"; not "MPA" or "mn", which case tells apart.
    if (const auto found = units.find(lower_case(spelled)); found != units.end()) return found->second;
    return std::nullopt;
}

double length_in_mm(std::string_view unit, const std::string& where) {
    const auto known = unit_in_ours(unit);
    if (!known || known->name != "mm")
        throw InvalidInput(
            fmt::format("{}: {} is no unit of length. Tell the unit of positions in the map, as 'unit: mm' "
                        "(mm, cm, m, um or in).",
                        where, mesh::cited(unit)));
    return known->factor;
}

NameAndUnit name_and_unit(std::string_view cell) {
    cell = trimmed(cell);
    const auto split = [&](std::size_t name_end, std::string_view unit) {
        return NameAndUnit{std::string(trimmed(cell.substr(0, name_end))), std::string(trimmed(unit))};
    };
    if (!cell.empty() && (cell.back() == ')' || cell.back() == ']')) {
        const std::size_t open = cell.find_last_of(cell.back() == ')' ? '(' : '[');
        if (open != cell.npos && open > 0) {
            const std::string_view unit = cell.substr(open + 1, cell.size() - open - 2);
            // "C7[0]" is a component, "strain [1]" has no dimension.
            const bool is_component = cell.back() == ']' && cell[open - 1] != ' ' && !unit.empty() &&
                                      unit.find_first_not_of("0123456789") == unit.npos;
            if (is_component) return {std::string(cell), ""};
            if (cell.back() == ']' || unit_in_ours(unit) || unit.size() <= 4) return split(open, unit);
        }
    }
    if (const std::size_t in = cell.rfind(" in "); in != cell.npos && unit_in_ours(cell.substr(in + 4)))
        return split(in, cell.substr(in + 4));
    if (const std::size_t at = cell.find_last_of("_/ ");
        at != cell.npos && at > 0 && is_plain_suffix(cell.substr(at + 1)))
        return split(cell[at - 1] == '/' || cell[at - 1] == ',' ? at - 1 : at, cell.substr(at + 1));
    return {std::string(cell), ""};
}

bool is_unit_cell(std::string_view cell) {
    constexpr std::size_t longest = 12;
    if (cell.empty() || cell.size() > longest) return false;
    return is_bracketed(cell) || unit_in_ours(cell) || cell == "%" || cell == "mm/mm" || cell == "1" || cell == "V" ||
           cell == "mV" || cell == "g" || cell == "Hz" || cell == "J" || cell == "mJ" || cell == "mm/s" ||
           cell == "mm/min";
}

}  // namespace palpate::identify
