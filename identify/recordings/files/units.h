#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace palpate::identify {

/// A unit of a file in ours.
struct UnitInOurs {
    std::string name;   // "mm", "N", "N*mm", "MPa", "s" or "rad"
    double factor = 1;  // what one of the file's is
};

/// Of a unit that is known, however it is spelled: "kN", "Meters", "N.mm", "sec", "µm".
std::optional<UnitInOurs> unit_in_ours(std::string_view unit);

/// The factor of a unit of length. @throws InvalidInput naming `where`.
double length_in_mm(std::string_view unit, const std::string& where);

/// A header's cell: "Load (kN)", "Force [N]", "Kraft in N", "force_N".
struct NameAndUnit {
    std::string name;
    std::string unit;  // "": none is told
};
NameAndUnit name_and_unit(std::string_view cell);

/// Is it what a row of units holds: "(mm)", "[N]", "sec", "%"?
bool is_unit_cell(std::string_view cell);

}  // namespace palpate::identify
