#pragma once

#include <vector>

#include "identify/preflight/prospects/linear_point.h"

namespace palpate::identify {

/// What is asked of the evidence before an effect is named, as the diagnosis asks it.
struct NamingRules {
    double least_evidence = 0;       // ln Bayes factor
    double least_next_to_noise = 0;  // the same where what is left without the effect may pass for noise
    double most_left = 1;            // whitened rms up to which it may
    double least_lead = 5;           // over every other effect
};

/// True cases of an effect: what each does to the readings where it is as strong as its prior expects.
struct EffectCases {
    Eigen::MatrixXd readings;               // over sigma (N x cases)
    Eigen::MatrixXd values;                 // the screened numbers behind them (p x cases)
    std::vector<Eigen::Index> alternative;  // place, direction... of each
};

/// Cases drawn from an effect's prior: an alternative, a direction among its numbers, and the size sqrt(p) prior
/// standard deviations, which is the rms of p normal numbers. Those that alter nothing are left out. The same each
/// time.
EffectCases draw_cases(const EffectSignature& signature);

/// Expected evidence of effects for readings d = a d_1 that one of them has altered, noise apart. Each alternative i of
/// an effect, with whitened columns B_i over its prior (p = 1), has [score test; `screen`]
///   ln BF_i(a) = a^2 |L_i^-1 B_i^T V^-1 d_1|^2 / 2 - ln |1 + M_i| / 2,  M_i = B_i^T V^-1 B_i = L_i L_i^T - 1,
/// and the effect ln mean_i exp(ln BF_i).
class EvidenceOfSignatures {
public:
    EvidenceOfSignatures(const Whitening& V, const std::vector<EffectSignature>& signatures);

    /// By which factor each case of effect `own` has to be stronger or weaker than it is, to be named by the rules
    /// (cases); infinite: another effect explains it as well, or it is never enough.
    struct LeastFactors {
        std::vector<double> named;  // first ahead of every other effect
        std::vector<double> seen;   // first told from nothing at all
        std::vector<int> rival;     // the effect that holds a case up longest; -1: none does
    };
    LeastFactors least_factors(std::size_t own, const EffectCases& cases, const NamingRules& rules) const;

private:
    struct Whitened {
        Eigen::MatrixXd over_prior;                   // V^-1 B (N x alternatives p)
        std::vector<Eigen::MatrixXd> inverse_factor;  // L^-1 of each alternative (p x p)
        Eigen::VectorXd occam;                        // ln |1 + M| / 2 of each, less ln 2 where only one side counts
        Eigen::Index p = 0;
        bool one_sided = false;
    };
    /// What each alternative's evidence grows by with a^2 (alternatives x cases); -infinity: on the wrong side.
    static Eigen::MatrixXd growth(const Whitened& effect, const Eigen::MatrixXd& readings);

    const Whitening& V_;
    std::vector<Whitened> effects_;
};

}  // namespace palpate::identify
