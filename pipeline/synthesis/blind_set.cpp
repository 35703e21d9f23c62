#include "pipeline/synthesis/blind_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "pipeline/synthesis/loading/load_sequence.h"
#include "pipeline/synthesis/loading/reading_faults.h"
#include "pipeline/synthesis/rig/tool_forces.h"

namespace palpate::pipeline {
namespace {

constexpr double default_noise = 0.02;  // of the rms displacement, where something is hidden
constexpr double visible = 5;           // sigmas that an effect changes the readings by, at least

/// "gravity, friction".
std::string names_of(const std::vector<EffectSpec>& specs) {
    std::vector<std::string> names;
    std::ranges::transform(specs, std::back_inserter(names), &EffectSpec::effect);
    return fmt::format("{}", fmt::join(names, ", "));
}

/// Three digits, as somebody would tell it; never more.
double rounded_down(double noise) {
    if (noise <= 0) return 0;
    const double unit = std::pow(10, std::floor(std::log10(noise)) - 2);
    return std::stod(fmt::format("{:.3g}", std::floor(noise / unit) * unit));
}

class BlindSetMaker {
public:
    BlindSetMaker(const Specimen& specimen, const ProbeOptions& probing, const BlindSetOptions& options,
                  std::uint64_t seed, int threads, const Progress& progress)
        : specimen_(specimen),
          probing_(probing),
          options_(options),
          specs_(read_specs(options.hide)),
          sequence_(sequence_of(options, specs_)),
          seed_(seed),
          play_{.continuous = sequence_.continuous, .threads = threads},
          progress_(progress) {
        std::erase_if(specs_, [](const EffectSpec& spec) { return spec.effect == no_effect; });
        std::ranges::for_each(specs_, check_spec);
    }

    BlindSet execute() {
        blind_set_.is_blind = !options_.hide.empty();
        blind_set_.notes = sequence_.notes;
        const double size = specimen_.model->size();
        plan_ = make_plan(specimen_, sequence_, size * probing_.largest_displacement(specimen_.in_small_strain()),
                          play_.threads, progress_);
        choose_noise();
        hide_all();
        play_together();
        write_set();
        blind_set_.notes.insert(blind_set_.notes.end(), plan_.notes.begin(), plan_.notes.end());
        return std::move(blind_set_);
    }

private:
    std::vector<Points> seen_bare() const {
        return seen(specimen_, {.setting = specimen_.setting}, plan_.histories, plan_.baseline);
    }

    void choose_noise() {
        noise_is_specified_ = options_.noise.has_value() || !blind_set_.is_blind;
        blind_set_.noise = options_.noise.value_or(0);
        if (noise_is_specified_) return;
        const std::vector<Points> baseline = seen_bare();
        blind_set_.noise = rounded_down(default_noise * strength_of(specimen_, baseline, baseline).displacement);
    }

    void hide_all() {
        const EffectSpec* in_sigmas = first_with(&identify::SynthesisNeeds::noise, specs_);
        if (in_sigmas && blind_set_.noise == 0) {
            throw InvalidInput(fmt::format(
                "effect '{}' is given in sigmas of the noise, and there is none; give --noise", in_sigmas->effect));
        }
        refuse_what_rigs_do_not_show();
        for (std::size_t w = 0; w < specs_.size(); ++w) {
            report(progress_, "hiding " + specs_[w].effect,
                   static_cast<double>(w) / static_cast<double>(specs_.size()));
            const auto same = [&](const EffectSpec& spec) { return spec.effect == specs_[w].effect; };
            const auto which = std::count_if(specs_.begin(), specs_.begin() + static_cast<std::ptrdiff_t>(w), same);
            const std::vector<EffectSampler> samplers =
                samplers_of(specimen_, plan_, specs_[w], sequence_.timing, seed_, static_cast<int>(which));
            blind_set_.hidden.push_back(hide(specimen_, plan_, samplers, {.noise = blind_set_.noise}, play_));
            report(progress_, "hiding " + specs_[w].effect, 1);
            if (!reads_forces_alone()) blind_set_.noise = see_to_visibility(blind_set_.hidden.back(), blind_set_.noise);
        }
    }

    void refuse_what_rigs_do_not_show() const {
        if (specimen_.driven.empty()) return;
        const auto places =
            std::ranges::count_if(specimen_.driven, [](const auto& course) { return course.drive.tool >= 0; });
        for (const EffectSpec& spec : specs_) {
            const std::string why = identify::find_effect(spec.effect)->why_not_driven(static_cast<int>(places));
            if (!why.empty())
                throw InvalidInput(fmt::format("effect '{}' cannot be hidden with {}: {}", spec.effect,
                                               options_.rig.tool.empty() ? "--pressure or --tendon" : "--tool", why));
        }
    }

    /// The noise at which an effect is seen that is weaker than asked for, though it is as strong as is plausible.
    double see_to_visibility(const HiddenEffect& hidden, double noise) {
        if (hidden.is_specified || hidden.strength.change >= visible * noise) return noise;
        const bool is_of_forces = reads_forces_alone();
        if (is_of_forces ? options_.rig.reaction_noise.has_value() : noise_is_specified_) {
            blind_set_.notes.push_back(fmt::format(
                "'{}' changes the readings by only {:.2g} sigma, the strongest plausible here; give a smaller {}, "
                "another --seed, or its numbers.",
                hidden.effect.name, hidden.strength.change / noise, is_of_forces ? "--reaction-noise" : "--noise"));
            return noise;
        }
        blind_set_.notes.push_back(
            fmt::format("'{}' changes the readings by only {:.2g} {}, the strongest plausible here; the noise was "
                        "reduced to match.",
                        hidden.effect.name, hidden.strength.change, is_of_forces ? "N" : "mm"));
        return rounded_down(hidden.strength.change / visible);
    }

    bool reads_forces_alone() const { return !options_.rig.markers; }

    /// All effects in force. A probe that finds no equilibrium then presses less, three times at most.
    void play_together() {
        constexpr int attempts = 4;
        std::vector<skeleton::EffectRecord> effects;
        std::ranges::transform(blind_set_.hidden, std::back_inserter(effects), &HiddenEffect::effect);
        conditions_ = true_conditions(specimen_, effects);
        // What yields gives way for good: to seek long is in vain.
        SimulationOptions options = play_;
        options.is_patient = !conditions_.setting.effects.plasticity;
        for (int attempt = 0;; ++attempt) {
            try {
                // From the bare paths, not from trials: told again, the same effects give the same digits.
                paths_ = simulate(specimen_, conditions_, plan_.histories, options, &plan_.baseline);
            } catch (const SolverFailure& failure) {
                throw SolverFailure(
                    fmt::format("with {} the body has no equilibrium: {}", names_of(specs_), failure.what()));
            }
            std::vector<char> failed;
            failed.reserve(paths_.size());
            for (const EquilibriumPath& path : paths_) failed.push_back(path.empty());
            if (failed.front()) {
                throw SolverFailure(fmt::format(
                    "with {} in it the body finds no equilibrium though nothing touches it; hide less of it",
                    names_of(specs_)));
            }
            if (std::ranges::count(failed, 1) == 0) return;
            if (attempt + 1 < attempts) {
                reduce_forces(specimen_, plan_, failed, play_.threads);
                blind_set_.notes.push_back(fmt::format(
                    "With what is hidden {} probes find no equilibrium: they press less than they would without.",
                    std::ranges::count(failed, 1)));
            } else {
                leave_out(plan_, failed);
                std::erase_if(paths_, [](const EquilibriumPath& path) { return path.empty(); });
                return;
            }
        }
    }

    ReadingFaults faults() const {
        return {.noise = blind_set_.noise,
                .outlier_share = conditions_.outlier_share,
                .outlier_width = conditions_.outlier_width,
                .missing = options_.missing,
                .unlabelled = options_.unlabelled};
    }

    void write_set() {
        identify::MeasurementSet& set = blind_set_.set;
        set = specimen_.set;
        set.continuous = sequence_.continuous;
        if (blind_set_.noise > 0) set.position_noise = blind_set_.noise;
        include_material();
        const std::vector<Points> baseline = seen_bare();
        std::vector<Points> hidden = seen(specimen_, conditions_, plan_.histories, paths_);
        std::size_t s = 0;
        for (std::size_t c = 0; c < plan_.histories.size(); ++c) {
            for (std::size_t row = 0; row < plan_.histories[c].rows.size(); ++row, ++s) {
                identify::LoadState state = plan_.histories[c].state(row);
                state.readings = read_markers(state, hidden[s], faults(), seed_);
                state.reactions = reactions_of(specimen_, conditions_, plan_.histories[c], row, paths_[c][row]);
                set.states.push_back(std::move(state));
                blind_set_.configurations.push_back(paths_[c][row]);
            }
        }
        if (reads_forces_alone()) {
            compare_forces();
        } else {
            blind_set_.strength = strength_of(specimen_, baseline, hidden);
            blind_set_.strength.add(conditions_.scatter(blind_set_.noise));
        }
        read_reactions(set);
        if (reads_forces_alone()) leave_markers_out(set);
    }

    /// How much each effect, and all together, change the forces of tools.
    void compare_forces() {
        const auto felt = [&](const TrueConditions& conditions, const std::vector<EquilibriumPath>& paths) {
            return forces_of_tools(specimen_, conditions, plan_.histories, paths);
        };
        const std::vector<Points> bare = felt({.setting = specimen_.setting}, plan_.baseline);
        for (HiddenEffect& hidden : blind_set_.hidden) {
            const TrueConditions alone = true_conditions(specimen_, {hidden.effect});
            hidden.strength = strength_in_forces(
                bare, felt(alone, changes_equilibrium(hidden.effect)
                                      ? simulate(specimen_, alone, plan_.histories, play_, &plan_.baseline)
                                      : plan_.baseline));
        }
        blind_set_.strength = strength_in_forces(bare, felt(conditions_, paths_));
    }

    /// As nothing but the tool's load cell reads.
    static void leave_markers_out(identify::MeasurementSet& set) {
        set.markers.clear();
        set.position_noise.reset();
        for (identify::LoadState& state : set.states) state.readings.clear();
    }

    /// Adds the load cell's noise.
    void read_reactions(identify::MeasurementSet& set) {
        double squares = 0;
        int count = 0;
        for (const identify::LoadState& state : set.states) {
            for (const identify::ReactionReading& reading : state.reactions) {
                squares += reading.force.squaredNorm();
                ++count;
            }
        }
        if (count == 0) return;
        const double by_default = blind_set_.noise > 0 ? rounded_down(default_noise * std::sqrt(squares / count)) : 0;
        double noise = options_.rig.reaction_noise.value_or(by_default);
        if (reads_forces_alone()) {
            for (const HiddenEffect& hidden : blind_set_.hidden) {
                if (hidden.strength.change > 0)
                    noise = see_to_visibility(hidden, noise);
                else
                    blind_set_.notes.push_back(fmt::format(
                        "'{}' does not change the forces of the tools, which alone are read.", hidden.effect.name));
            }
            blind_set_.noise = noise;
        }
        if (noise <= 0) return;
        set.reaction_noise = noise;
        for (identify::LoadState& state : set.states) {
            for (identify::ReactionReading& reading : state.reactions) add_reaction_noise(state, noise, seed_, reading);
        }
    }

    void include_material() {
        if (!specimen_.material) return;
        identify::MaterialGuess guess;
        if (!blind_set_.is_blind || options_.include_material) {
            guess = {specimen_.material->young, specimen_.material->poisson};
        } else if (first_with(&identify::SynthesisNeeds::specified_poisson, specs_)) {
            // A body of another Poisson's ratio lacks nothing, unless somebody said what it should be.
            guess.poisson = specimen_.material->poisson;
            blind_set_.notes.push_back(
                fmt::format("The set declares a Poisson's ratio of {:g}; the hidden one differs.", guess.poisson));
        }
        if (std::isfinite(guess.poisson)) blind_set_.set.material = guess;
        // Where and what regions are is known, how stiff they are is asked for.
        if (!std::isfinite(guess.young))
            for (mesh::MaterialRegion& region : blind_set_.set.regions) region.young.reset();
    }

    const Specimen& specimen_;
    const ProbeOptions& probing_;
    const BlindSetOptions& options_;
    std::vector<EffectSpec> specs_;
    Sequence sequence_;
    std::uint64_t seed_;
    SimulationOptions play_;
    Progress progress_;

    Plan plan_;
    TrueConditions conditions_;
    std::vector<EquilibriumPath> paths_;
    bool noise_is_specified_ = true;
    BlindSet blind_set_;
};

}  // namespace

BlindSet synthesise(const Specimen& specimen, const ProbeOptions& probing, const BlindSetOptions& options,
                    std::uint64_t seed, int threads, const Progress& progress) {
    probing.validate();
    options.validate();
    return BlindSetMaker(specimen, probing, options, seed, threads, progress).execute();
}

}  // namespace palpate::pipeline
