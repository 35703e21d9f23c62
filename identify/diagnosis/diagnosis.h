#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/locate/missing_source.h"
#include "identify/diagnosis/statistics/held_out.h"
#include "identify/diagnosis/statistics/outliers/outliers.h"
#include "mesh/core/contact.h"

namespace palpate::identify {

enum class Verdict {
    adequate,        // what is left is noise
    missing_effect,  // the explanation leaves only noise
    ambiguous,       // two or more explain it alike
    unexplained,     // something is missing that the catalogue does not hold
};
inline constexpr std::array<const char*, 4> verdict_names{"adequate", "missing-effect", "ambiguous", "unexplained"};

/// An effect's numbers as they are told, each with its standard deviation, and all with their covariance.
struct EffectEstimate {
    skeleton::EffectRecord effect = {};
    std::vector<double> sd = {};
    Eigen::MatrixXd covariance = {};  // (n x n); empty: unknown
};

/// Effects in force together, fitted: an explanation that was tried.
struct FittedExplanation {
    std::vector<std::shared_ptr<const EffectHypothesis>>
        effects;  // beyond those that are known, in the order of the fit
    Refit fit;
    double log_bayes_factor = 0;  // against the model without effects
    HeldOut held_out = {};
    std::string objection = {};  // reason why it is not claimed despite its evidence; empty: no objection

    std::vector<std::string> names() const;
    bool has(const std::string& name) const;
    /// The numbers of one of its effects. @param which of those of this name, in the order of the fit
    EffectEstimate estimate(const std::string& name, int which = 0) const;
};

/// One effect by itself.
struct Candidate {
    std::shared_ptr<const EffectHypothesis> effect;
    double screened = 0;          // ln Bayes factor without refitting
    double log_bayes_factor = 0;  // after the refit where there was one
    double identifiable = 1;      // share of its signature that the other unknowns cannot absorb
    std::string objection = {};   // of its refit
    double probability = 0;       // among all candidates and none
    double predicted_rms_mm = 0;  // what the screen expects to be left
    bool is_unfitted = false;     // its refit found no equilibrium: the ln Bayes factor is the screen's
    std::optional<Refit> refit = std::nullopt;
    std::optional<HeldOut> held_out = std::nullopt;
    EffectEstimate estimate = {};  // its parameter estimates; within a joint explanation, the joint ones
};

/// A body turned in the room, with its supports.
struct BodyTurn {
    Vec3 axis;  // unit
    double degrees;
};

struct NextProbe {
    std::string kind, why = {};
    std::optional<mesh::Contact> contact = std::nullopt;
    int probe = -1;                               // of the set, that is to be repeated
    std::vector<double> times = {};               // at which the load is to be read [s]
    std::optional<BodyTurn> turn = std::nullopt;  // of the unloaded body
    double sigmas = 0;  // how far the explanations are apart there, root of the sum of squares in a state
    double rms_mm = 0;  // the same over all coordinates
};

/// Which effects a model lacks, inferred from its residuals.
struct Diagnosis {
    Verdict verdict = Verdict::adequate;
    std::vector<std::string> explanation;
    std::vector<Candidate> ranking;              // by evidence, most first
    std::vector<FittedExplanation> tried;        // all that were fitted, single ones and several together
    std::optional<FittedExplanation> explained;  // what the explanation comes from, outliers apart
    Refit baseline;                              // nothing added, under the law that explains most
    HeldOut baseline_held_out;
    int law = 0;                       // of the explanation
    std::vector<double> law_evidence;  // of each law without effects, less the best; -inf: no equilibria
    Outliers outliers;                 // readings as the set numbers them
    Problem problem;                   // without the outliers
    std::optional<NextProbe> next_probe;
    std::optional<MissingSource> missing;   // what the baseline leaves, located, whatever its name; none where adequate
    int independent = 0;                    // readings, see independent_readings()
    double false_claims = 0;                // probability that an effect is claimed where none is missing, at most
    bool large_deformation_failed = false;  // none of its laws found its equilibria
    bool noise_known = true;
    double noise = 0;                // 1 sigma, told or estimated, rms [mm]
    std::vector<std::string> notes;  // what a user should know, in words

    /// The fit that explains most: that of the explanation where there is one, else the baseline.
    const Refit& best() const;
};

}  // namespace palpate::identify
