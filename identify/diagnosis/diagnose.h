#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/fit/nearby.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/statistics/held_out.h"
#include "identify/diagnosis/statistics/outliers.h"
#include "mesh/progress.h"

namespace palpate::identify {

enum class Verdict {
    adequate,        // what is left is noise
    missing_effect,  // the explanation leaves only noise
    ambiguous,       // two or more explain it alike
    unexplained,     // something is missing that the catalogue does not hold
};
inline constexpr std::array<const char*, 4> verdict_names{"adequate", "missing-effect", "ambiguous", "unexplained"};

struct DiagnoseOptions {
    std::vector<std::string> without;           // effects left out of the catalogue
    std::vector<skeleton::EffectRecord> known;  // effects that the model has already: in every explanation, fitted anew
    std::optional<int> law;                     // the only one to be tried; absent: the one that explains most
    std::optional<NeighbouringFit> near;        // a fit to begin with, instead of a guess
    bool screen = true;                         // false: the baseline alone, for a comparison
    int refits = 4;                             // candidates that are confirmed by a refit, at most
    int together = 4;                           // effects in one explanation, at most; 1: single ones only
    int refits_together = 8;                    // of several effects, at most
    double least_screen = 3;                    // ln Bayes factor of the screen below which none is refitted
    double least_evidence = 10;                 // ln Bayes factor of the refit, to claim an effect
    double least_lead = 5;                      // over the runner-up
    double most_left = 1.1;                     // whitened rms, for what is left to be noise
    double most_left_together = 1.06;           // the same for several effects: they overfit more easily
    double most_left_held_out = 1.2;            // the same on probes left out
    double most_gap = 1.06;                     // the same over that on probes fitted, where it is above 1
    double effect_error = 0.1;                  // share of an effect that discretisation may alter: up to twice the
                                                // 1 to 6 % that meshes of the default size are off by
    double most_pull = 8;                       // largest pull of a nuisance, in prior sd; doubled for a plastic body
    double least_outliers = 100;                // the same for outliers: one reading of 15 sigma, say
    double mesh_error = 0.005;  // share of the displacement that discretisation error may mimic as an effect
    double resolution = 0.01;   // of the displacement: noise that is not specified is no less, as of a mesh
    double idealisation_evidence =
        60;  // least ln Bayes factor beside an effect whose own idealisation leaves a residual
    RefitOptions refit;
    /// Is an effect left out of the catalogue?
    bool leaves_out(const EffectHypothesis& effect) const;
    void validate() const;  // @throws InvalidInput naming option, value and bound
};

/// An effect's numbers as they are told, each with its standard deviation.
struct EffectEstimate {
    skeleton::EffectRecord effect = {};
    std::vector<double> sd = {};
};

/// Effects in force together, fitted: an explanation that was tried.
struct FittedExplanation {
    std::vector<std::shared_ptr<const EffectHypothesis>>
        effects;  // beyond those that are known, in the order of the fit
    Refit fit;
    double log_bayes_factor = 0;  // against the model without effects
    HeldOut held_out = {};
    std::string objection = {};  // reason why it is not claimed despite its evidence; empty: no objection

    bool has(const std::string& name) const;
    /// The numbers of one of its effects.
    EffectEstimate estimate(const std::string& name) const;
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
    int independent = 0;                    // readings, see independent_readings()
    bool large_deformation_failed = false;  // none of its laws found its equilibria
    bool noise_known = true;
    double noise = 0;                // 1 sigma, told or estimated, rms [mm]
    std::vector<std::string> notes;  // what a user should know, in words

    /// The fit that explains most: that of the explanation where there is one, else the baseline.
    const Refit& best() const;
};

/// Screens the catalogue with a score test, refits the leading candidates under the relevant material laws, and returns
/// a verdict: adequate, missing effect, ambiguous or unexplained. [design: score test, Laplace evidence, leave-one-out]
/// @throws SolverFailure when the model has no equilibria under these loads; InvalidInput without labelled readings.
Diagnosis diagnose(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                   const Progress& progress = {});

}  // namespace palpate::identify
