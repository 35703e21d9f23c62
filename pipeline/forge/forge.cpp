#include "pipeline/forge/forge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "pipeline/forge/readings.h"
#include "pipeline/forge/sequence.h"

namespace palpate::pipeline {
namespace {

constexpr double default_noise = 0.02;  // of the rms displacement, where something is hidden
constexpr double visible = 5;           // sigmas that an effect changes the readings by, at least

std::vector<std::string> names_of(const std::vector<Wish>& wishes) {
    std::vector<std::string> names;
    names.reserve(wishes.size());
    for (const Wish& wish : wishes) names.push_back(wish.effect);
    return names;
}

/// Three digits, as somebody would tell it; never more.
double rounded_down(double noise) {
    if (noise <= 0) return 0;
    const double unit = std::pow(10, std::floor(std::log10(noise)) - 2);
    return std::stod(fmt::format("{:.3g}", std::floor(noise / unit) * unit));
}

class Forge {
public:
    Forge(const Specimen& specimen, const ProbeOptions& probing, const ForgeOptions& options, std::uint64_t seed,
          int threads, const Progress& progress)
        : specimen_(specimen),
          probing_(probing),
          options_(options),
          wishes_(read_wishes(options.hide)),
          sequence_(sequence_of(options, wishes_)),
          seed_(seed),
          play_{.continuous = sequence_.continuous, .threads = threads},
          progress_(progress) {
        std::erase_if(wishes_, [](const Wish& wish) { return wish.effect == "none"; });
        std::ranges::for_each(wishes_, check_wish);
    }

    Forged execute() {
        forged_.is_blind = !options_.hide.empty();
        forged_.notes = sequence_.notes;
        const double size = specimen_.model->size();
        plan_ = make_plan(specimen_, options_, sequence_.rhythm,
                          size * probing_.largest_displacement(specimen_.in_small_strain()), play_.threads, progress_);
        choose_noise();
        hide_all();
        play_together();
        write_set();
        forged_.notes.insert(forged_.notes.end(), plan_.notes.begin(), plan_.notes.end());
        return std::move(forged_);
    }

private:
    std::vector<Points> seen_bare() const {
        return seen(specimen_, {.setting = specimen_.setting}, plan_.courses, plan_.bare);
    }

    void choose_noise() {
        noise_is_told_ = options_.noise.has_value() || !forged_.is_blind;
        forged_.noise = options_.noise.value_or(0);
        if (noise_is_told_) return;
        const std::vector<Points> bare = seen_bare();
        forged_.noise = rounded_down(default_noise * strength_of(specimen_, bare, bare).displacement);
    }

    void hide_all() {
        const Wish* in_sigmas = first_with(&identify::HidingNeeds::noise, wishes_);
        if (in_sigmas && forged_.noise == 0) {
            throw InvalidInput(fmt::format("effect '{}' is told in sigmas of the noise, and there is none; say --noise",
                                           in_sigmas->effect));
        }
        for (std::size_t w = 0; w < wishes_.size(); ++w) {
            report(progress_, "hiding " + wishes_[w].effect,
                   static_cast<double>(w) / static_cast<double>(wishes_.size()));
            const std::vector<Draft> drafts = drafts_of(specimen_, plan_, wishes_[w], sequence_.rhythm, seed_);
            forged_.hidden.push_back(hide(specimen_, plan_, drafts, {.noise = forged_.noise}, play_));
            report(progress_, "hiding " + wishes_[w].effect, 1);
            see_to_visibility(forged_.hidden.back());
        }
    }

    /// What is weaker than asked for, though it is as strong as is sensible, is seen at less noise.
    void see_to_visibility(const Hidden& hidden) {
        if (hidden.is_told || hidden.strength.change >= visible * forged_.noise) return;
        const double sigmas = hidden.strength.change / forged_.noise;
        if (noise_is_told_) {
            forged_.notes.push_back(
                fmt::format("Effect '{}' changes the readings by {:.2g} sigma only, though it is as strong as is "
                            "sensible here; say less --noise, another --seed, or its numbers.",
                            hidden.effect.name, sigmas));
            return;
        }
        forged_.noise = rounded_down(hidden.strength.change / visible);
        forged_.notes.push_back(
            fmt::format("Effect '{}' changes the readings by {:.2g} mm only, as strong as is sensible here: the noise "
                        "is made as much smaller.",
                        hidden.effect.name, hidden.strength.change));
    }

    std::vector<skeleton::Effect> effects() const {
        std::vector<skeleton::Effect> all;
        all.reserve(forged_.hidden.size());
        for (const Hidden& hidden : forged_.hidden) all.push_back(hidden.effect);
        return all;
    }

    /// All effects in force. A probe that finds no equilibrium then presses less, three times at most.
    void play_together() {
        constexpr int attempts = 4;
        world_ = world_of(specimen_, effects());
        // What yields gives way for good: to seek long is in vain.
        PlayOptions options = play_;
        options.is_patient = !world_.setting.effects.plasticity;
        for (int attempt = 0;; ++attempt) {
            try {
                // From the bare paths, not from trials: told again, the same effects give the same digits.
                paths_ = play(specimen_, world_, plan_.courses, options, &plan_.bare);
            } catch (const SolverFailure& failure) {
                throw SolverFailure(fmt::format("with {} in it the body does not bear itself: {}",
                                                fmt::join(names_of(wishes_), ", "), failure.what()));
            }
            std::vector<char> failed;
            failed.reserve(paths_.size());
            for (const Path& path : paths_) failed.push_back(path.empty());
            if (failed.front()) {
                throw SolverFailure(fmt::format(
                    "with {} in it the body finds no equilibrium though nothing touches it; hide less of it",
                    fmt::join(names_of(wishes_), ", ")));
            }
            if (std::ranges::count(failed, 1) == 0) return;
            if (attempt + 1 < attempts) {
                press_less(specimen_, plan_, failed, play_.threads);
                forged_.notes.push_back(fmt::format(
                    "With what is hidden {} probes find no equilibrium: they press less than they would without.",
                    std::ranges::count(failed, 1)));
            } else {
                leave_out(plan_, failed);
                std::erase_if(paths_, [](const Path& path) { return path.empty(); });
                return;
            }
        }
    }

    ReadingFaults faults() const {
        return {.noise = forged_.noise,
                .outlier_share = world_.off_share,
                .outlier_width = world_.off_width,
                .missing = options_.missing,
                .unlabelled = options_.unlabelled};
    }

    void write_set() {
        identify::MeasurementSet& set = forged_.set;
        set = specimen_.set;
        set.continuous = sequence_.continuous;
        if (forged_.noise > 0) set.position_noise = forged_.noise;
        tell_material();
        const std::vector<Points> bare = seen_bare();
        std::vector<Points> hidden = seen(specimen_, world_, plan_.courses, paths_);
        std::size_t s = 0;
        for (std::size_t c = 0; c < plan_.courses.size(); ++c) {
            for (std::size_t row = 0; row < plan_.courses[c].rows.size(); ++row, ++s) {
                identify::LoadState state = plan_.courses[c].state(row);
                state.readings = read_markers(state, hidden[s], faults(), seed_);
                set.states.push_back(std::move(state));
                forged_.configurations.push_back(paths_[c][row]);
            }
        }
        forged_.strength = strength_of(specimen_, bare, hidden);
        forged_.strength.add(world_.scatter(forged_.noise));
    }

    void tell_material() {
        if (!specimen_.material) return;
        identify::MaterialGuess guess;
        if (!forged_.is_blind || options_.tell_material) {
            guess = {specimen_.material->young, specimen_.material->poisson};
        } else if (first_with(&identify::HidingNeeds::told_poisson, wishes_)) {
            // A body of another Poisson's ratio lacks nothing, unless somebody said what it should be.
            guess.poisson = specimen_.material->poisson;
            forged_.notes.push_back(
                fmt::format("The set tells a Poisson's ratio of {:g}, which the hidden one belies.", guess.poisson));
        }
        if (std::isfinite(guess.poisson)) forged_.set.material = guess;
    }

    const Specimen& specimen_;
    const ProbeOptions& probing_;
    const ForgeOptions& options_;
    std::vector<Wish> wishes_;
    Sequence sequence_;
    std::uint64_t seed_;
    PlayOptions play_;
    Progress progress_;

    Plan plan_;
    World world_;
    std::vector<Path> paths_;
    bool noise_is_told_ = true;
    Forged forged_;
};

}  // namespace

Forged forge(const Specimen& specimen, const ProbeOptions& probing, const ForgeOptions& options, std::uint64_t seed,
             int threads, const Progress& progress) {
    probing.validate();
    options.validate();
    return Forge(specimen, probing, options, seed, threads, progress).execute();
}

}  // namespace palpate::pipeline
