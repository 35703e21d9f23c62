#pragma once

#include <string>
#include <vector>

#include "identify/effects/hiding.h"
#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

/// An effect that somebody wants hidden, and those of its numbers that they told.
struct Wish {
    std::string effect;  // "none": nothing
    std::vector<skeleton::EffectParameter> given;
};

/// What is wrong with the form EFFECT[:name=value,...], in words; empty: nothing. Names and values are not looked at.
std::string slip_in(const std::string& wish);

/// Reads them. @pre no slip in any. @throws InvalidInput for a value that is no number, a name given twice, an effect
/// wished for twice, "none" beside others.
std::vector<Wish> read_wishes(const std::vector<std::string>& wishes);

/// The first wish for an effect that needs this to show; null: there is none.
const Wish* first_with(bool identify::HidingNeeds::*need, const std::vector<Wish>& wishes);

/// An effect as it would be wished for: "gravity:gx=0,gy=-4387.2,gz=0". Read back, it is the same.
std::string to_wish(const skeleton::Effect& effect);

}  // namespace palpate::pipeline
