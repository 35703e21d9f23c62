#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/preflight/prospects/evidence_of_signatures.h"
#include "identify/preflight/prospects/own_number.h"

namespace palpate::identify {

/// Could an effect be named from a set, and how strong would it have to be?
struct EffectProspect {
    std::shared_ptr<const EffectHypothesis> effect;
    std::string why_not = {};  // it cannot show at all; empty: it can
    double share = 0;          // of cases as strong as its prior expects that would be named
    // Of its prior's expected strength, so that it is named: in half of the cases, and in the most visible one;
    // infinite: no strength is enough.
    double least = INFINITY, easiest = INFINITY;
    double seen = INFINITY;  // in half of the cases, so that something is seen to be missing, whatever its name
    // What the effect in the median case alters where it is just strong enough to be named, else to be seen.
    double rms_sigma = 0, rms_mm = 0, max_mm = 0;
    double prior_rms_mm = 0;  // and as strong as its prior expects
    std::optional<OwnNumber> own = {}, own_easiest = {}, own_prior = {};
    std::vector<std::string> confused_with = {};  // effects that hold up its name in a quarter of the cases or more
};

/// By first-order signatures and the rules of the diagnosis, in the order of the signatures.
std::vector<EffectProspect> effect_prospects(const BodyModel& model, const Problem& problem, const Whitening& V,
                                             const std::vector<EffectSignature>& signatures,
                                             const DiagnoseOptions& options);

/// One reading that is off by itself: how far it has to be to be set aside.
EffectProspect prospect_of_single_readings(const std::shared_ptr<const EffectHypothesis>& effect,
                                           const Problem& problem, const DiagnoseOptions& options);

}  // namespace palpate::identify
