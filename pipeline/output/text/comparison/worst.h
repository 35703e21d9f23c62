#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// Where in a body's box a place lies: "+x end, top". z is up; a side is within a fifth of the box of its end.
/// @param box "min" and "max" of the body at rest
std::string part_of_body(const nlohmann::json& at, const nlohmann::json& box);

/// The probes and markers that compare.json finds worst, as a table: how far off, and where.
std::string worst_table(const nlohmann::json& compare);

}  // namespace palpate::pipeline
