#include "pipeline/forge/trial.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "mesh/errors.h"

namespace palpate::pipeline {

Trial::Trial(const Specimen& specimen, const Plan& plan, std::size_t count, const PlayOptions& options, double noise)
    : specimen_(specimen), options_(options), noise_(noise) {
    count = std::min(count, plan.courses.size());
    courses_.assign(plan.courses.begin(), plan.courses.begin() + static_cast<std::ptrdiff_t>(count));
    near_.assign(plan.bare.begin(), plan.bare.begin() + static_cast<std::ptrdiff_t>(count));
    bare_ = seen(specimen, {.setting = specimen.setting}, courses_, near_);
    bears_less_than_.assign(count, std::numeric_limits<double>::infinity());
}

std::optional<Strength> Trial::strength(const skeleton::Effect& effect, double x) {
    std::vector<int> alive;
    for (int c = 0; c < static_cast<int>(courses_.size()); ++c) {
        if (x < bears_less_than_[c]) alive.push_back(c);
    }
    const auto most = static_cast<int>(courses_.size() / 4);
    const auto given_up = static_cast<int>(courses_.size() - alive.size());
    if (given_up > most) return std::nullopt;
    PlayOptions options = options_;
    options.is_patient = false;
    options.most_failures = most - given_up;
    if (!played(effect, alive, options)) return std::nullopt;
    if (paths_.front().empty() || std::ranges::count_if(paths_, &Path::empty) > most) return std::nullopt;

    for (const int c : alive) {
        if (paths_[c].empty()) {
            bears_less_than_[c] = x;
        } else {
            near_[c] = paths_[c];
        }
    }
    return compared(effect);
}

Strength Trial::told_strength(const skeleton::Effect& effect) {
    std::vector<int> all(courses_.size());
    std::iota(all.begin(), all.end(), 0);
    return played(effect, all, options_) ? compared(effect) : Strength{};
}

/// Plays some of the courses. False: not even the tangent at rest is stable.
bool Trial::played(const skeleton::Effect& effect, const std::vector<int>& which, const PlayOptions& options) {
    paths_ = near_;
    if (!moves_body(effect)) return true;
    std::vector<Course> courses;
    std::vector<Path> near;
    for (const int c : which) {
        courses.push_back(courses_[c]);
        near.push_back(near_[c]);
    }
    try {
        std::vector<Path> paths = play(specimen_, world_of(specimen_, {effect}), courses, options, &near);
        paths_.assign(courses_.size(), {});
        for (std::size_t i = 0; i < which.size(); ++i) paths_[which[i]] = std::move(paths[i]);
    } catch (const SolverFailure&) {
        return false;
    }
    return true;
}

Strength Trial::compared(const skeleton::Effect& effect) const {
    const World world = world_of(specimen_, {effect});
    Strength strength = strength_of(specimen_, bare_, seen(specimen_, world, courses_, paths_));
    strength.add(world.scatter(noise_));
    return strength;
}

}  // namespace palpate::pipeline
