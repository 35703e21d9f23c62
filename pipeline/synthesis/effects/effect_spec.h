#pragma once

#include <string>
#include <vector>

#include "identify/effects/hiding.h"
#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

/// In place of an effect: nothing is hidden.
inline constexpr const char* no_effect = "none";

/// Specification of an effect to be hidden, with some of its parameters.
struct EffectSpec {
    std::string effect;  // or no_effect
    std::vector<skeleton::EffectParameter> given;
};

/// What is wrong with the form EFFECT[:name=value,...], in words; empty: nothing. Names and values are not looked at.
std::string objection_to_spec(const std::string& spec);

/// Reads them. @pre objection_to_spec finds nothing in any. @throws InvalidInput for a value that is no number, a name
/// given twice, an effect specified twice, no_effect beside others.
std::vector<EffectSpec> read_specs(const std::vector<std::string>& specs);

/// The first spec whose effect has this need; null: none has.
const EffectSpec* first_with(bool identify::SynthesisNeeds::*need, const std::vector<EffectSpec>& specs);

/// An effect as its specification: "gravity:gx=0,gy=-4387.2,gz=0". Read back, it is the same.
std::string to_spec(const skeleton::EffectRecord& effect);

}  // namespace palpate::pipeline
