#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/fit/nearby.h"
#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

struct DiagnoseOptions {
    std::vector<std::string> without;           // effects left out of the catalogue
    std::vector<skeleton::EffectRecord> known;  // effects that the model has already: in every explanation, fitted anew
    std::optional<int> law;                     // the only one to be tried; absent: the one that explains most
    std::optional<NeighbouringFit> near;        // a fit to begin with, instead of a guess
    bool screen = true;                         // false: the baseline alone, for a comparison
    int refits = 4;           // candidates that are confirmed by a refit, at most: the price of a diagnosis
    int together = 4;         // effects in one explanation, at most; 1: single ones only
    int refits_together = 8;  // of several effects, at most: the price of explanations by several
    double least_screen = 3;  // ln Bayes factor of the screen below which none is refitted: odds of 20, where a claim
                              // asks for tens of thousands
    double false_claims = 1e-3;    // probability that an effect is claimed where none is missing, at most
    double least_lead = 5;         // over the runner-up: odds of 150
    double false_refusals = 1e-3;  // probability that chance alone refuses what is right, each check
    double noise_accuracy = 0.1;   // share by which a noise that is told may be off: it has one digit
    double most_pull = 8;          // largest pull of a nuisance, in prior sd, which is known to a factor of two; 4 come
                                   // up once in 16,000. Doubled for a plastic body
    double least_outliers = 100;   // least ln Bayes factor of outliers: one reading of 15 sigma, say
    // The next three are design choices: with less, errors of meshes and of idealisations are named as effects; with
    // more, weak effects are not.
    double mesh_error = 0.005;  // share of the displacement that discretisation error may mimic as outliers
    double resolution = 0.01;   // of the displacement: noise that is not specified is no less, as of a mesh
    double idealisation_evidence =
        60;  // least ln Bayes factor beside an effect whose own idealisation leaves a residual
    RefitOptions refit;
    /// Is an effect left out of the catalogue?
    bool leaves_out(const EffectHypothesis& effect) const;
    /// Least ln Bayes factor of the refit, to claim an effect: ln(effects / false_claims). Where nothing is missing a
    /// Bayes factor is 1 on average, so that it is K or more with a probability of 1/K at most [Markov], one of n
    /// effects' with n/K.
    double least_evidence() const;
    /// Largest whitened rms of so many readings that passes for noise: what chance exceeds with a probability of
    /// `false_refusals`, and at least what a noise of `noise_accuracy` may be off by.
    double most_left(Eigen::Index readings) const;
    void validate() const;  // @throws InvalidInput naming option, value and bound
};

}  // namespace palpate::identify
