#include <fmt/format.h>

#include <algorithm>

#include "identify/effects/catalogue.h"
#include "identify/measurements/files/read_markers.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/forecast/forecast.h"
#include "pipeline/cli/simulate/motion.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/csv/played_positions.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "pipeline/synthesis/effects/effect_spec.h"
#include "skeleton/effects/effect.h"
#include "skeleton/model/io/model_io.h"

// What plays a model: equilibria or motion.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// How an effect is given with its numbers; of gravity a direction alone is enough.
std::string spec_to_write(const skeleton::KnownEffect& effect) {
    if (effect.name == "gravity") return "gravity:gz=-9810";
    std::string spec = effect.name;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p)
        spec += fmt::format("{}{}=VALUE", p == 0 ? ":" : ",", effect.parameters[p].name);
    return spec;
}

/// Are an effect's numbers the components of one vector?
bool is_a_vector(const std::string& effect) {
    const auto hypothesis = identify::effect_named(effect);
    return hypothesis && hypothesis->magnitude();
}

/// A model with effects added; one that it has already is replaced. What a vector leaves out is 0.
skeleton::Model with_effects(skeleton::Model model, const std::vector<std::string>& specs) {
    for (const EffectSpec& spec : read_specs(specs)) {
        const skeleton::KnownEffect* known = skeleton::find_known_effect(spec.effect);
        if (!known) {
            identify::find_effect(spec.effect);  // which names those that there are
            throw InvalidInput(fmt::format("effect '{}' is a fault of measurements: no model plays it", spec.effect));
        }
        if (spec.given.empty() && !known->parameters.empty())
            throw InvalidInput(
                fmt::format("effect '{}' has no numbers: give them, e.g. {}", spec.effect, spec_to_write(*known)));
        skeleton::EffectRecord effect{spec.effect, spec.given};
        const bool has_components = is_a_vector(spec.effect) && !effect.parameters.empty();
        for (const skeleton::KnownParameter& parameter : known->parameters) {
            const auto given = std::ranges::find(effect.parameters, parameter.name, &skeleton::EffectParameter::name);
            if (given != effect.parameters.end())
                given->unit = parameter.unit;
            else if (has_components)
                effect.parameters.push_back({parameter.name, 0, parameter.unit});
        }
        skeleton::make_physics(effect);  // which refuses what is missing or out of range
        std::erase_if(model.effects, [&](const skeleton::EffectRecord& own) { return own.name == effect.name; });
        model.effects.push_back(std::move(effect));
    }
    return model;
}

bool moves(const Forecast& forecast) {
    constexpr double rounding = 1e-9;  // [mm]
    return forecast.largest >= rounding;
}

/// Why nothing moves, where none of the states has a force.
std::string why_still(const SimulateOptions& options, const std::vector<identify::LoadState>& states,
                      const std::vector<Forecast>& forecasts) {
    if (have_forces(states) || std::ranges::any_of(forecasts, moves)) return {};
    return fmt::format(
        "{} states no force, so nothing moves: tools and actuators are not played here. 'palpate compare' plays those "
        "of a measurement set, and 'palpate play' lets you press the model by hand.",
        options.probes.string());
}

/// The largest displacement of each state and its interval; of many states the first ones.
std::string in_words(const std::vector<identify::LoadState>& states, const std::vector<Forecast>& forecasts) {
    constexpr std::size_t most = 12;
    std::string text;
    for (std::size_t s = 0; s < std::min(most, states.size()); ++s) {
        const Forecast& here = forecasts[s];
        text += fmt::format("  probe {:<4} ", states[s].probe);
        text += !moves(here) ? "does not move\n"
                             : fmt::format("moves by {:.3g} mm at most (95 % interval {:.3g} to {:.3g} mm)\n",
                                           here.largest, here.low, here.high);
    }
    if (states.size() > most) text += fmt::format("  and {} more\n", states.size() - most);
    return text;
}

}  // namespace

Outcome simulate(const SimulateOptions& options, const Common& common) {
    const fs::path output = options.output.empty() ? fs::path("simulation") : options.output;
    refuse_to_overwrite(output, common.force);
    const skeleton::Model model = with_effects(skeleton::read_model(options.model), options.add);
    if (options.dt) return simulate_motion(options, model, output);
    const std::vector<identify::Marker> markers =
        options.markers.empty() ? std::vector<identify::Marker>{} : identify::read_markers(options.markers);
    const std::vector<identify::LoadState> states = identify::read_probes(options.probes);
    const fs::path posterior = options.posterior.empty() ? options.model.parent_path() : options.posterior;
    const std::optional<ModelUncertainty> uncertainty = read_uncertainty(model, posterior, options.draws);
    if (!uncertainty && !options.posterior.empty() && options.draws > 0)
        throw InvalidInput(posterior.string() + ": holds no particles.csv with particles; identify writes it");
    const std::vector<Forecast> forecasts = forecast(model, states, uncertainty, common.threads);

    std::vector<mesh::SeriesStep> steps;
    nlohmann::json results = nlohmann::json::array();
    for (std::size_t s = 0; s < states.size(); ++s) {
        const Forecast& found = forecasts[s];
        const fs::path file = output / fmt::format("simulation_{:03}.vtp", s);
        mesh::MeshData data{.points = {{"displacement [mm]", found.displacement}}};
        if (found.sd.size() > 0) data.points.push_back({"sd of a coordinate [mm]", found.sd});
        mesh::write_vtp(file, model.surface, data);
        steps.push_back({static_cast<double>(s), file});
        results.push_back({{"probe", states[s].probe},
                           {"time", states[s].time},
                           {"max_displacement_mm", found.largest},
                           {"iterations", found.equilibrium.iterations}});
        if (found.sd.size() > 0) results.back()["max_displacement_95_mm"] = {found.low, found.high};
    }
    mesh::write_pvd(output / "simulation.pvd", steps);
    if (const std::string why = why_still(options, states, forecasts); !why.empty()) Console::warning(why);
    Outcome outcome;
    outcome.text = fmt::format("{}: {}.\n", (output / "simulation.pvd").string(),
                               mesh::count_of(std::ssize(states), "equilibrium", "equilibria"));
    const fs::path positions = output / "positions.csv";
    mesh::write_text(positions, played_positions_csv(model, states, forecasts, markers));
    outcome.json = {
        {"file", (output / "simulation.pvd").string()}, {"positions", positions.string()}, {"states", results}};
    if (uncertainty) {
        outcome.text += in_words(states, forecasts);
        const Vec3 sizes = model.surface.vertices.colwise().maxCoeff() - model.surface.vertices.colwise().minCoeff();
        const std::vector<std::string> beyond =
            extrapolations(uncertainty->measured, states, forecasts, sizes.maxCoeff());
        Console::notices(beyond);
        if (uncertainty->forecast_error.relative == 0 && std::ranges::any_of(forecasts, moves))
            Console::notice("Intervals are of stiffness alone: how far the model itself is off was not estimated.");
        outcome.json["draws"] = uncertainty->draws.size();
        outcome.json["forecast_error"] = uncertainty->forecast_error.relative;
        outcome.json["extrapolations"] = beyond;
    }
    outcome.text += fmt::format(
        "Positions of {}{}: {}\nNext: paraview {}\n", markers.empty() ? "the skin's vertices" : "the markers",
        uncertainty ? ", with their intervals" : "", positions.string(), (output / "simulation.pvd").string());
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_simulate(CLI::App& app) {
    auto* sub = subcommand(
        app, "simulate",
        "Plays the model: equilibria under given contacts, with intervals where a posterior is there, or motion.",
        "  palpate simulate model.json --probes set/probes.csv --markers set/markers.csv -o played\n"
        "  palpate simulate model.json --probes set/probes.csv --add gravity:gz=-9810 -o hanging\n"
        "  palpate simulate model.json --probes set/probes.csv --dt 0.002 --duration 0.5 -o moved\n",
        [this] { return commands::simulate(simulate, common); });
    sub->add_option("MODEL", simulate.model, "model.json")->required();
    sub->add_option("--probes", simulate.probes, "probes.csv: probe,time,x,y,z,fx,fy,fz,radius [mm, N]")
        ->type_name("PATH")
        ->required();
    sub->add_option("-o,--output", simulate.output,
                    "Folder for simulation.pvd and positions.csv; simulation by default");
    sub->add_option("--markers", simulate.markers,
                    "markers.csv: marker,x,y,z [mm], whose positions are written; the skin's vertices by default")
        ->type_name("PATH");
    sub->add_option(
           "--add", simulate.add,
           "An effect to play besides the model's own, EFFECT:name=value,... ('palpate effects NAME' lists the\n"
           "names): gravity:gz=-9810. Repeatable; one that the model has is replaced")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::Validator([](std::string& spec) { return objection_to_spec(spec); }, "EFFECT:name=value,..."));
    sub->add_option("--posterior", simulate.posterior,
                    "Folder with particles.csv and identify.json, for the intervals of equilibria; by default that of\n"
                    "the model, where they are")
        ->type_name("PATH");
    sub->add_option("--draws", simulate.draws, "Draws from the posterior, for intervals; 0: none")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    auto* dt =
        sub->add_option("--dt", simulate.dt,
                        "Motion: a frame every so many seconds. The load of a row acts since the row before it,\n"
                        "that of a probe's last row to the end. A first row of time 0, before others, is what the\n"
                        "body is in equilibrium with when it begins; without one it begins at rest")
            ->check(CLI::PositiveNumber)
            ->group("Motion");
    auto* duration = sub->add_option("--duration", simulate.duration, "How long each probe is played [s]")
                         ->check(CLI::PositiveNumber)
                         ->needs(dt)
                         ->group("Motion");
    dt->needs(duration);
    sub->add_option("--damping", simulate.damping,
                    "Damping ratio of the softest mode; by default damping as it was identified, or 0.1")
        ->check(CLI::NonNegativeNumber)
        ->needs(dt)
        ->group("Motion");
    sub->add_flag("--implicit", simulate.implicit,
                  "One implicit step a frame: stable and fast, and damped the more the longer dt is")
        ->needs(dt)
        ->group("Motion");
}

}  // namespace palpate::pipeline
