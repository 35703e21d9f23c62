#include "pipeline/forge/strength.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

double rms(const Eigen::VectorXd& values) {
    return values.size() > 0 ? std::sqrt(values.squaredNorm() / static_cast<double>(values.size())) : 0;
}

/// All coordinates one after the other.
Eigen::VectorXd stacked(const std::vector<Points>& readings) {
    Eigen::Index size = 0;
    for (const Points& state : readings) size += state.size();
    Eigen::VectorXd all(size);
    Eigen::Index at = 0;
    for (const Points& state : readings) {
        all.segment(at, state.size()) = Eigen::Map<const Eigen::VectorXd>(state.data(), state.size());
        at += state.size();
    }
    return all;
}

/// A part of a plan, in which an effect is tried.
class Trial {
public:
    Trial(const Specimen& specimen, const Plan& plan, std::size_t count, const PlayOptions& options, double noise)
        : specimen_(specimen), options_(options), noise_(noise) {
        count = std::min(count, plan.courses.size());
        courses_.assign(plan.courses.begin(), plan.courses.begin() + static_cast<std::ptrdiff_t>(count));
        near_.assign(plan.bare.begin(), plan.bare.begin() + static_cast<std::ptrdiff_t>(count));
        bare_ = seen(specimen, {.setting = specimen.setting}, courses_, near_);
    }

    bool is_whole(const Plan& plan) const { return courses_.size() == plan.courses.size(); }
    Strength strength_of_bare() const { return strength_of(specimen_, bare_, bare_); }

    /// The strength of an effect over the probes that find an equilibrium; none: some do not, and `all` should.
    std::optional<Strength> strength(const skeleton::Effect& effect, bool all = true) {
        const World world = world_of(specimen_, {effect});
        if (!moves_body(effect)) return compared(world, near_, effect);
        std::vector<Path> paths;
        try {
            paths = play(specimen_, world, courses_, options_, &near_);
        } catch (const SolverFailure&) {
            return std::nullopt;  // not even its tangent at rest is stable
        }
        if (all && std::ranges::any_of(paths, [](const Path& path) { return path.empty(); })) return std::nullopt;
        near_ = paths;
        return compared(world, paths, effect);
    }

private:
    Strength compared(const World& world, const std::vector<Path>& paths, const skeleton::Effect& effect) const {
        Strength strength = strength_of(specimen_, bare_, seen(specimen_, world, courses_, paths));
        strength.add(outlier_variance(effect, noise_));
        return strength;
    }

    const Specimen& specimen_;
    PlayOptions options_;
    double noise_;
    std::vector<Course> courses_;
    std::vector<Path> near_;
    std::vector<Points> bare_;
};

struct Found {
    double x = 0;  // of a draft
    Strength strength;
    double change() const { return strength.change; }
};

/// The strength that would move the untouched body by `aim` (rms over the markers) [mm], by its tangent.
double strength_at_rest(const Specimen& specimen, const Plan& plan, const Draft& draft, double aim) {
    const identify::BodyModel& model = *specimen.model;
    const Eigen::VectorXd& q = plan.bare.front().front();
    const double x = 1e-3 * draft.start;  // little enough to be in proportion
    const World world = world_of(specimen, {draft.at(x)});
    const Eigen::VectorXd force = model.residual(q, world.setting, {}) - model.residual(q, specimen.setting, {});
    const Eigen::VectorXd step = model.tangent(q, specimen.setting, {})->solve(force);
    const double small = 1e-4 * model.size() / std::max(step.cwiseAbs().maxCoeff(), 1e-300);
    const Eigen::VectorXd moved = model.advance(q, small * step, specimen.setting);
    const Points change = model.observe(moved, specimen.setting) - model.observe(q, specimen.setting);
    const double per_strength = rms(stacked({change})) / (small * x);
    return per_strength > 0 ? aim / per_strength : draft.start;
}

/// A strength whose change lies within [least, most]; else the nearest to that. Secants in logarithms, bracketed: more
/// strength is taken to change more, and to be too much where there is no equilibrium.
Found seek(Trial& trial, const Draft& draft, double start, double least, double most) {
    constexpr int plays = 9;
    const double aim = std::sqrt(least * most);
    const auto distance = [&](const Found& found) {
        return found.change() > 0 ? std::abs(std::log(found.change() / aim)) : std::numeric_limits<double>::infinity();
    };
    Found best, last;
    double weak = 0, strong = std::numeric_limits<double>::infinity();  // strengths that are too little, too much
    double x = std::min(start, draft.most);
    for (int i = 0; i < plays; ++i) {
        const std::optional<Strength> strength = trial.strength(draft.at(x));
        if (!strength) {
            strong = x;
            x = weak > 0 ? std::sqrt(weak * strong) : x / 8;
            continue;
        }
        const Found now{x, *strength};
        if (distance(now) < distance(best)) best = now;
        const bool is_weak = now.change() < least;
        if ((!is_weak && now.change() <= most) || (is_weak && x == draft.most)) return best;
        (is_weak ? weak : strong) = x;

        double slope = draft.slope, factor = 8;
        if (last.change() > 0 && now.change() > 0) {
            slope = std::clamp(std::log(now.change() / last.change()) / std::log(now.x / last.x), 0.2, 5.0);
        }
        if (now.change() > 0) factor = std::clamp(std::pow(aim / now.change(), 1 / slope), 1 / 8.0, 8.0);
        last = now;
        x = std::min(x * factor, draft.most);
        // not where it was found to be too little or too much
        if (x <= weak || x >= strong) x = weak > 0 ? std::sqrt(weak * strong) : strong / 8;
    }
    return best;
}

}  // namespace

double outlier_variance(const skeleton::Effect& effect, double noise) {
    if (effect.name != "outliers") return 0;
    const double share = effect.parameters[0].value, width = effect.parameters[1].value * noise;
    return share * width * width;
}

Strength strength_of(const Specimen& specimen, const std::vector<Points>& bare, const std::vector<Points>& hidden) {
    const auto markers = static_cast<Eigen::Index>(specimen.set.markers.size());
    Points rest(markers, 3);
    for (Eigen::Index m = 0; m < markers; ++m) rest.row(m) = specimen.set.markers[m].rest;
    std::vector<Points> displacements, changes;
    for (std::size_t s = 0; s < bare.size(); ++s) {
        if (!hidden[s].allFinite()) continue;  // it found no equilibrium
        displacements.emplace_back(bare[s] - rest);
        changes.emplace_back(hidden[s] - bare[s]);
    }
    const Eigen::VectorXd u = stacked(displacements), change = stacked(changes);
    const double scaling = u.squaredNorm() > 0 ? change.dot(u) / u.squaredNorm() : 0;
    return {rms(u), rms(change), rms(change - scaling * u)};
}

void Strength::add(double variance) {
    for (double* rms : {&change, &beyond}) *rms = std::sqrt(*rms * *rms + variance);
}

Hidden hide(const Specimen& specimen, const Plan& plan, const std::vector<Draft>& drafts, const Target& target,
            const PlayOptions& options) {
    constexpr std::size_t few = 7;  // courses: the untouched body, and pushes and pulls at all levels
    Trial all(specimen, plan, plan.courses.size(), options, target.noise);
    const double noise = 5 * target.noise;
    const double share = target.share * all.strength_of_bare().displacement;
    const double least = std::max(0.9 * share, noise), most = std::max(1.15 * share, 1.15 * noise);

    if (drafts.front().is_told) {
        const skeleton::Effect effect = drafts.front().at(1);
        return {effect, true, all.strength(effect, false).value_or(Strength{})};
    }
    const auto visibility = [&](const Strength& s) {  // 1: as asked for
        const double told_apart = target.noise > 0 ? s.beyond / (3 * target.noise) : 1;
        return std::min({1.0, s.change / least, told_apart});
    };
    Hidden best;
    for (const Draft& draft : drafts) {
        double start = draft.start;
        if (draft.acts_at_rest) start = strength_at_rest(specimen, plan, draft, std::sqrt(least * most));
        Trial some(specimen, plan, few, options, target.noise);
        if (!draft.is_local && !some.is_whole(plan)) {
            // what is asked for of all, where it is tried
            const double ratio = some.strength_of_bare().displacement / all.strength_of_bare().displacement;
            start = seek(some, draft, start, least * ratio, most * ratio).x;
            if (start == 0) continue;
        }
        const Found found = seek(all, draft, start, least, most);
        if (found.x > 0 && visibility(found.strength) > visibility(best.strength)) {
            best = {draft.at(found.x), false, found.strength};
        }
        if (visibility(best.strength) >= 1) break;
    }
    if (best.strength.change == 0) {
        throw SolverFailure(fmt::format(
            "the body bears effect '{}' at no strength, or does not show it; tell its numbers, as in --hide {}",
            drafts.front().at(1).name, to_wish(drafts.front().at(drafts.front().start))));
    }
    return best;
}

}  // namespace palpate::pipeline
