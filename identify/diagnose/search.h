#pragma once

#include "identify/diagnose/baselines.h"
#include "identify/diagnose/screen.h"

namespace palpate::identify {

/// Seeks what explains a problem, among some effects: screens them, refits what leads under the laws that matter, and
/// puts several together as long as the evidence grows.
///
/// Forward: next to the two single effects that explain most, what leads the screen there is added, and so on from the
/// best pair. Backward: what the rest can do without is dropped again; a swap for another is tried at each place.
class Search {
public:
    /// Keeps references to all but the problem. `effects`: that may be missing.
    Search(const BodyModel& model, const Problem& problem, const Baselines& baselines,
           const std::vector<std::shared_ptr<const Effect>>& effects, const DiagnoseOptions& options,
           const Progress& progress);

    void single_effects();
    void put_together();  // @pre single_effects

    std::vector<Candidate> ranking() const;  // by evidence, most first
    const std::vector<Explained>& tried() const { return tried_; }
    /// By evidence; none where nothing was fitted.
    const Explained* leader() const;

private:
    std::optional<Explained> refit_with(const Refit& base, const Screened& screened) const;
    std::optional<Explained> refit_from(const Explanation& explanation, const Refit& start,
                                        const std::vector<std::shared_ptr<const Effect>>& effects) const;
    std::vector<Screened> screen_at(const Refit& base, const std::vector<std::string>& without) const;
    void screen_all();
    int most_promising_law() const;
    void confirm_single_effects();
    void confirm_at_the_answer_to_loads(int law);
    void try_other_laws(std::size_t tried);
    void confirm_under(int law);
    void keep_better(Explained found);
    std::optional<Explained> carry_over(const Explained& single, int law) const;
    bool extend(std::size_t from, int most);
    bool claims(const Explained& explained) const;
    bool something_claims() const;
    bool little_is_left() const;
    bool takes_leader_for(const Effect& other) const;
    void drop_and_swap();
    const Problem& problem_for(const Explanation& explanation) const;
    std::size_t index_of_leader() const;
    bool was_tried(const std::vector<std::string>& names) const;

    const BodyModel& model_;
    const Problem problem_, stages_;
    const Baselines& baselines_;
    const std::vector<std::shared_ptr<const Effect>>& effects_;
    const DiagnoseOptions& options_;
    const Progress& progress_;
    std::vector<std::vector<Screened>> screened_;  // under each law, by evidence, most first
    std::vector<Candidate> ranking_;
    std::vector<Explained> tried_;
    std::vector<std::vector<std::string>> rejected_;  // of several effects, refitted and not worth it
    int refits_together_ = 0;                         // of several effects
};

}  // namespace palpate::identify
