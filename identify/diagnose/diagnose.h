#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnose/held_out.h"
#include "identify/diagnose/nearby.h"
#include "identify/diagnose/outliers.h"
#include "identify/diagnose/refit.h"
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
    std::vector<std::string> without;     // effects left out of the catalogue
    std::vector<skeleton::Effect> known;  // effects that the model has already: in every explanation, fitted anew
    std::optional<int> law;               // the only one to be tried; absent: the one that explains most
    std::optional<Nearby> near;           // a fit to begin with, instead of a guess
    bool screen = true;                   // false: the baseline alone, for a comparison
    int refits = 4;                       // candidates that are confirmed by a refit, at most
    int together = 4;                     // effects in one explanation, at most; 1: single ones only
    int refits_together = 8;              // of several effects, at most
    double least_screen = 3;              // ln Bayes factor of the screen below which none is refitted
    double least_evidence = 10;           // ln Bayes factor of the refit, to claim an effect
    double least_lead = 5;                // over the runner-up
    double most_left = 1.1;               // whitened rms, for what is left to be noise
    double most_left_together = 1.06;     // the same where several effects explain it: they bend to more
    double most_left_held_out = 1.2;      // the same on probes left out
    double most_gap = 1.06;               // the same over that on probes fitted, where it is above 1
    double most_strain = 8;               // of a nuisance, in its prior sd; twice as much where the body flows
    double least_outliers = 100;          // the same for outliers: one reading of 15 sigma, say
    double mesh_error = 0.005;            // of the displacement: what errors of a mesh may do in the way of an effect
    double resolution = 0.01;             // of the displacement: what nobody told of noise is no less, as of a mesh
    double idealised = 60;  // ln Bayes factor that an effect's idealisation may leave to another, at least
    RefitOptions refit;
    /// Is an effect left out of the catalogue?
    bool leaves_out(const Effect& effect) const;
    void validate() const;  // @throws InvalidInput naming option, value and bound
};

/// An effect's numbers as they are told, each with its standard deviation.
struct Told {
    skeleton::Effect effect = {};
    std::vector<double> sd = {};
};

/// Effects in force together, fitted: an explanation that was tried.
struct Explained {
    std::vector<std::shared_ptr<const Effect>> effects;  // beyond those that are known, in the order of the fit
    Refit fit;
    double log_bayes_factor = 0;  // over nothing
    HeldOut held_out = {};
    std::string objection = {};  // why it is no claim, whatever its evidence; empty: nothing speaks against it

    bool has(const std::string& name) const;
    /// The numbers of one of its effects.
    Told told(const std::string& name) const;
};

/// One effect by itself.
struct Candidate {
    std::shared_ptr<const Effect> effect;
    double screened = 0;          // ln Bayes factor without refitting
    double log_bayes_factor = 0;  // after the refit where there was one
    double keep = 1;              // how much of its signature the rest cannot swallow
    std::string objection = {};   // of its refit
    double probability = 0;       // among all candidates and none
    double predicted_rms_mm = 0;  // what the screen expects to be left
    bool is_unfitted = false;     // its refit found no equilibrium: the ln Bayes factor is the screen's
    std::optional<Refit> refit = std::nullopt;
    std::optional<HeldOut> held_out = std::nullopt;
    Told told = {};  // its numbers; in an explanation of several those that it has there
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

/// What a model lacks, judged on its errors.
struct Diagnosis {
    Verdict verdict = Verdict::adequate;
    std::vector<std::string> explanation;
    std::vector<Candidate> ranking;      // by evidence, most first
    std::vector<Explained> tried;        // all that were fitted, single ones and several together
    std::optional<Explained> explained;  // what the explanation comes from, outliers apart
    Refit baseline;                      // nothing added, under the law that explains most
    HeldOut baseline_held_out;
    int law = 0;                       // of the explanation
    std::vector<double> law_evidence;  // of each law without effects, less the best; -inf: no equilibria
    Outliers outliers;                 // readings as the set numbers them
    Problem problem;                   // without the outliers
    std::optional<NextProbe> next_probe;
    int independent = 0;                  // readings, see independent_readings()
    bool lost_large_deformation = false;  // none of its laws found its equilibria
    bool noise_known = true;
    double noise = 0;                // 1 sigma, told or estimated, rms [mm]
    std::vector<std::string> notes;  // what a user should know, in words

    /// The fit that explains most: that of the explanation where there is one, else the baseline.
    const Refit& best() const;
};

/// Screens the catalogue by force signatures, refits what leads under the laws that matter, and says what is missing,
/// or that nothing is, or that it does not know. [design: score test, Laplace evidence, leave-one-out]
/// @throws SolverFailure when the model has no equilibria under these loads; InvalidInput without labelled readings.
Diagnosis diagnose(const BodyModel& model, const MeasurementSet& set, const DiagnoseOptions& options,
                   const Progress& progress = {});

}  // namespace palpate::identify
