#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/case/case.h"

namespace palpate::pipeline {

/// What the command line says on top of a case: settings by their place in case.yaml ("skeleton.spheres"), with values
/// as YAML writes them.
class CaseOverrides {
public:
    /// @throws std::logic_error where there is no such setting.
    void set(std::string_view place, std::string value);
    void set(std::string_view place, double value);
    bool has(std::string_view place) const;
    std::optional<std::uint64_t> seed;  // --seed, of any size; a case file holds up to 2e9

    /// @throws InvalidInput naming the flag, the value and what is allowed.
    void apply(Case& settings) const;
    /// Defaults, but for what is said.
    Case on_defaults() const;
    /// The same as flags, for a process of its own. @throws std::logic_error for a setting that has none.
    std::vector<std::string> flags() const;

private:
    std::map<std::string, std::string, std::less<>> overrides_;
};

/// Why a flag of this setting cannot take the value, in words; empty: it can.
std::string objection_to_value(std::string_view place, const std::string& value);

}  // namespace palpate::pipeline
