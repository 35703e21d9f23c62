#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "identify/loading/loads.h"
#include "identify/measurements/files/read_markers.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/forecast.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/csv/played_positions.h"
#include "pipeline/run/model_and_set.h"
#include "pipeline/synthesis/effects/effect_spec.h"
#include "skeleton/effects/effect.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/runtime/body.h"

// What plays a model: equilibria or motion.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// A probe's states in their order.
using Probe = std::vector<const identify::LoadState*>;

std::vector<Probe> by_probe(const std::vector<identify::LoadState>& states) {
    std::vector<Probe> probes;
    for (const identify::LoadState& state : states) {
        if (probes.empty() || probes.back().front()->probe != state.probe) probes.emplace_back();
        probes.back().push_back(&state);
    }
    return probes;
}

/// Plays a body through probes and writes its skin, frame by frame.
class Motion {
public:
    Motion(const SimulateOptions& options, const fs::path& output, const skeleton::Model& model, int contacts)
        : dt_(*options.dt),
          frames_(std::max(1, static_cast<int>(std::lround(*options.duration / dt_)))),
          implicit_(options.implicit),
          output_(output),
          model_(model),
          body_(model, {.damping_ratio = options.damping, .contacts = contacts}) {
        Console::notices(body_.notices());
        if (!implicit_) steps_ = std::max(1, static_cast<int>(std::ceil(dt_ / (0.5 * body_.stable_step()))));
    }

    /// Explicit steps a frame; one where they are implicit.
    int steps() const { return steps_; }
    const runtime::RayleighDamping& damping() const { return body_.damping(); }

    nlohmann::json play(const Probe& probe) {
        body_.reset();
        pressed_.clear();
        const identify::LoadState* acting = identify::acting_before(probe);
        if (acting) press(*acting);
        if (std::ranges::any_of(model_.spheres, &skeleton::Sphere::held)) body_.equilibrium();
        double furthest = write_frame();
        for (int frame = 0; frame < frames_; ++frame) {
            const identify::LoadState* now = identify::acting_at(probe, (frame + 0.5) * dt_);
            if (now != acting) press(*now);
            acting = now;
            if (implicit_) {
                body_.step_implicit(dt_);
            } else {
                body_.step_explicit(dt_ / steps_, steps_);
            }
            furthest = std::max(furthest, write_frame());
        }
        return {{"probe", probe.front()->probe}, {"frames", frames_ + 1}, {"max_displacement_mm", furthest}};
    }

    void write_series() const { mesh::write_pvd(output_ / "simulation.pvd", series_); }

private:
    // A contact that goes on is held, as what it does creeps; one that does not fades.
    void press(const identify::LoadState& state) {
        std::vector<Pressed> before;
        before.swap(pressed_);
        for (const mesh::Contact& contact : state.contacts) {
            if (contact.force.isZero(0)) continue;
            const auto goes_on = std::ranges::find_if(before, [&](const Pressed& was) {
                return was.at.point == contact.point && was.at.radius == contact.radius;
            });
            if (goes_on != before.end()) {
                pressed_.push_back(*goes_on);
                before.erase(goes_on);
            } else {
                pressed_.push_back({contact, body_.touch(contact.point, contact.radius)});
            }
            body_.push(pressed_.back().contact, contact.force);
        }
        for (const Pressed& was : before) body_.release(was.contact);
    }

    /// The largest displacement [mm].
    double write_frame() {
        using SkinRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
        const std::vector<float>& skin = body_.skin();
        const Points u =
            Eigen::Map<const SkinRows>(skin.data(), body_.vertex_count(), 3).cast<double>() - model_.surface.vertices;
        const auto frame = series_.size();
        const fs::path file = output_ / fmt::format("simulation_{:05}.vtp", frame);
        mesh::write_vtp(file, model_.surface, {.points = {{"displacement [mm]", u}}});
        series_.push_back({static_cast<double>(frame) * dt_, file});
        return u.rows() > 0 ? u.rowwise().norm().maxCoeff() : 0;
    }

    double dt_;
    int frames_;
    bool implicit_;
    int steps_ = 1;
    fs::path output_;
    const skeleton::Model& model_;
    runtime::Body body_;
    struct Pressed {
        mesh::Contact at;
        int contact = 0;  // of the body
    };
    std::vector<Pressed> pressed_;
    std::vector<mesh::SeriesStep> series_;
};

Outcome simulate_motion(const SimulateOptions& options, const skeleton::Model& model, const fs::path& output) {
    if (model.skin.empty())
        throw InvalidInput(options.model.string() + ": has no skin that could be pressed; give the model one");
    const std::vector<identify::LoadState> states = identify::read_probes(options.probes);
    std::size_t contacts = 1;
    for (const identify::LoadState& state : states) contacts = std::max(contacts, state.contacts.size());
    constexpr std::size_t most = 64;
    Motion motion(options, output, model, static_cast<int>(std::min(most, 2 * contacts + 2)));  // some of them fading
    Console::notice(fmt::format("Motion by {}; damping {}: {:.3g} 1/s times mass and {:.3g} s times stiffness.",
                                options.implicit ? fmt::format("implicit steps of {:g} s", *options.dt)
                                                 : fmt::format("{} explicit steps a frame", motion.steps()),
                                model.damping && !options.damping
                                    ? "as identified"
                                    : fmt::format("ratio {:g} of the softest mode", options.damping.value_or(0.1)),
                                motion.damping().alpha, motion.damping().beta));
    Outcome outcome;
    nlohmann::json probes = nlohmann::json::array();
    for (const Probe& probe : by_probe(states)) probes.push_back(motion.play(probe));
    motion.write_series();
    outcome.text = fmt::format("{0}: {1} probes in motion.\nNext: paraview {0}\n", (output / "simulation.pvd").string(),
                               probes.size());
    outcome.json = {{"file", (output / "simulation.pvd").string()},
                    {"dt_s", *options.dt},
                    {"steps_per_frame", motion.steps()},
                    {"damping", {{"mass", motion.damping().alpha}, {"stiffness", motion.damping().beta}}},
                    {"probes", probes}};
    return outcome;
}

/// How an effect is given with its numbers; of gravity a direction alone is enough.
std::string spec_to_write(const skeleton::KnownEffect& effect) {
    if (effect.name == "gravity") return "gravity:gz=-9810";
    std::string spec = effect.name;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p)
        spec += fmt::format("{}{}=VALUE", p == 0 ? ":" : ",", effect.parameters[p].name);
    return spec;
}

/// A model with effects added; one that it has already is replaced. What a direction leaves out is 0.
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
        for (const skeleton::KnownParameter& parameter : known->parameters) {
            const auto given = std::ranges::find(effect.parameters, parameter.name, &skeleton::EffectParameter::name);
            const bool is_of_gravity = spec.effect == "gravity" && !effect.parameters.empty();
            if (given != effect.parameters.end())
                given->unit = parameter.unit;
            else if (is_of_gravity)
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
