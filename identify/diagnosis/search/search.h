#pragma once

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/search/baselines.h"
#include "identify/diagnosis/search/screen.h"

namespace palpate::identify {

/// Searches the effects that explain a problem: screens them, refits the leading ones under the relevant laws, and
/// combines several as long as the evidence grows.
///
/// Forward: next to the two single effects that explain most, what leads the screen there is added, and so on from the
/// best pair. Backward: effects that became redundant are dropped; at each position an exchange for another one is
/// tried. Last resorts are none of these: they are asked for.
class Search {
public:
    /// Keeps references to all but the problem. `effects`: that may be missing.
    Search(const BodyModel& model, const Problem& problem, const Baselines& baselines,
           const std::vector<std::shared_ptr<const EffectHypothesis>>& effects, const DiagnoseOptions& options,
           const Progress& progress);

    void single_effects();
    void put_together();  // @pre single_effects
    /// Where single effects and several together explain too little: further ones of a kind that may repeat, and the
    /// effects that are last resorts. @pre single_effects
    void last_resorts();
    /// Fits once more, from where they stand, to a problem whose readings were corrected: the explanations with at
    /// least half the leader's evidence; the others are reassessed. @pre the baselines were
    void refit_tried(const Problem& corrected);

    std::vector<Candidate> ranking() const;  // by evidence, most first
    const std::vector<FittedExplanation>& tried() const { return tried_; }
    /// Does one of them explain the readings, with nothing to be said against it?
    bool has_claim() const;
    /// By evidence; none where nothing was fitted.
    const FittedExplanation* leader() const;

private:
    std::optional<FittedExplanation> refit_with(const Refit& base, const ScreenedEffect& screened) const;
    std::optional<FittedExplanation> refit_from(
        const Explanation& explanation, const Refit& start,
        const std::vector<std::shared_ptr<const EffectHypothesis>>& effects) const;
    std::vector<ScreenedEffect> screen_at(const Refit& base, const std::vector<std::string>& without) const;
    void screen_all();
    int most_promising_law() const;
    void confirm_single_effects();
    void confirm_at_load_response(int law);
    void try_other_laws(std::size_t tried);
    void confirm_under(int law);
    void restart_leader();
    void keep_better(FittedExplanation found);
    std::optional<FittedExplanation> carry_over(const FittedExplanation& single, int law) const;
    bool extend(std::size_t from, int most);
    bool claims(const FittedExplanation& explained) const;
    bool could_explain_anything(const Refit& base, const EffectHypothesis& effect) const;
    bool residual_is_small() const;
    bool is_confused_with_leader(const EffectHypothesis& other) const;
    void drop_and_swap();
    void repeat(std::size_t from);
    void drop_one_of_a_kind(std::size_t from);
    void seek_last_resort(const std::shared_ptr<const EffectHypothesis>& effect);
    const Problem& problem_for(const Explanation& explanation) const;
    std::size_t index_of_leader() const;
    std::vector<std::size_t> by_evidence() const;  // places in tried_, most first
    bool was_tried(const std::vector<std::string>& names) const;

    const BodyModel& model_;
    Problem problem_, stages_;
    const Baselines& baselines_;
    const std::vector<std::shared_ptr<const EffectHypothesis>>& effects_;
    const DiagnoseOptions& options_;
    const Progress& progress_;
    std::vector<std::vector<ScreenedEffect>> screened_;  // under each law, by evidence, most first
    std::vector<Candidate> ranking_;
    std::vector<FittedExplanation> tried_;
    std::vector<std::vector<std::string>> rejected_;  // of several effects, refitted and not worth it
    int refits_together_ = 0;                         // of several effects
    int independent_;                                 // readings
};

}  // namespace palpate::identify
