#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identify/particles/random.h"
#include "pipeline/forge/plan.h"
#include "pipeline/forge/wish.h"
#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

/// An effect in the making: all its numbers are told or drawn, but for how strong it is.
struct Draft {
    std::function<skeleton::Effect(double strength)> at;  // stronger with rising strength
    double start = 1, most = 1e9;                         // of strength; within [0, most] it is sensible
    double slope = 1;                                     // about d ln change / d ln strength
    double growth = 8;                                    // most that a trial may be stronger than the one before
    bool is_told = false;                                 // its strength too: at() gives the same whatever is asked
    bool is_local = false;                                // it may be felt by some probes only
    bool acts_at_rest = false;                            // on the untouched body, in proportion to its strength
};

/// What drafts are made of.
struct Drawing {
    const Specimen& specimen;
    const Plan& plan;
    const Wish& wish;
    Rhythm rhythm;
    identify::RandomStream random;
};

/// Drafts of an effect: what is told is taken, the rest drawn. Several: other places for it, for where it can hardly be
/// felt in the first one. Of an effect that a user made known one number may be left out, which is then its strength.
/// @throws InvalidInput for an effect or a number that is not known, with its likely spelling,
/// or an effect that cannot be on this specimen.
std::vector<Draft> drafts_of(const Specimen& specimen, const Plan& plan, const Wish& wish, const Rhythm& rhythm,
                             std::uint64_t seed);

/// Refuses names of effects and numbers that are not known, before anything is computed. @throws InvalidInput.
void check_wish(const Wish& wish);

}  // namespace palpate::pipeline
