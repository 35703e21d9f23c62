#include "identify/diagnose/baselines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"

namespace palpate::identify {

Explanation Baselines::start(const Problem& problem, int law, const Refit* neighbour) const {
    const auto& near = options_->near;
    Explanation result;
    if (near && near->fit->explanation.law == law) {
        result.law = law;
        result.theta = near->fit->explanation.theta;
    } else {
        result = first_guess(*model_, problem, law, options_->refit.threads);
        if (neighbour) result.theta = neighbour->explanation.theta;
    }
    for (const skeleton::Effect& known : options_->known) {
        const auto effect = find_effect(known.name);
        const auto numbers = effect->numbers(*model_, problem);
        if (numbers.empty()) continue;
        result.effects.push_back(effect);
        result.values.push_back(effect->values(numbers, known));
    }
    return result;
}

void Baselines::fit(const Problem& problem, std::vector<std::string>& notes, const Progress& progress) {
    std::string failure;
    std::optional<Refit> neighbour;  // of another law of large deformation: from one it is not far to the next
    // The linear one first, then from the last, which is the best behaved of the others.
    for (int i = 0; i < laws(); ++i) {
        const int law = i == 0 ? 0 : laws() - i;
        if (options_->law && *options_->law != law) continue;
        // Where more than this is left, whitened, other things matter than which of the laws of large deformation it
        // is.
        constexpr double much = 3;
        if (neighbour && neighbour->whitened_rms > much) continue;
        const std::string& name = model_->laws()[law];
        report(progress, "baseline, law " + name, 0.1 + 0.1 * i);
        RefitOptions how = options_->refit;
        std::optional<Refit> from = neighbour;
        if (neighbour) {
            how.steps = std::min(how.steps, 4);
        } else if (options_->near && options_->near->fit->explanation.law == law) {
            from = start_at(*options_->near, problem);
        }
        try {
            fits_[law] = identify::refit(*model_, problem, start(problem, law, neighbour ? &*neighbour : nullptr), how,
                                         from ? &*from : nullptr);
            if (law == 0) continue;
            neighbour = fits_[law];
            neighbour->V.reset();
        } catch (const SolverFailure& e) {
            failure = e.what();
            notes.push_back(fmt::format("Under the law {} the body has no equilibrium: {}", name, failure));
        }
    }
    if (std::ranges::none_of(fits_, [](const auto& found) { return found.has_value(); })) {
        throw SolverFailure("no law finds an equilibrium in every state: " + failure);
    }
}

void Baselines::refit(const Problem& problem, bool best_only) {
    const Refit* leading = &best();
    for (std::optional<Refit>& found : fits_) {
        if (!found || (best_only && &*found != leading)) continue;
        try {
            // from where it stands; the nuisances are made anew
            found->V.reset();
            found = identify::refit(*model_, problem, found->explanation, options_->refit, &*found);
        } catch (const SolverFailure&) {
            found.reset();
        }
    }
}

const Refit& Baselines::best() const {
    int best = 0;
    for (int law = 1; law < laws(); ++law) {
        if (evidence(law) > evidence(best)) best = law;
    }
    return *fits_[best];
}

}  // namespace palpate::identify
