#include "pipeline/play/play_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/effects/catalogue.h"
#include "identify/loading/creep.h"
#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/case/json_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/output/findings.h"
#include "pipeline/output/html/run_files.h"
#include "pipeline/output/ranking_row.h"
#include "pipeline/output/text/words.h"
#include "pipeline/play/sliders.h"
#include "pipeline/play/touch/set_text.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/runtime/body.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

/// A model of a page, and how it came about.
struct Candidate {
    fs::path file;
    std::string name, about;
    json errors = {};  // its errors as ladder.json tells them, or null
};

std::string with_words(const json& effects) {
    const auto names = effects.get<std::vector<std::string>>();
    return names.empty() ? "nothing added" : "with " + listed(names);
}

/// The models of a ladder's steps, and the one that it delivers.
std::vector<Candidate> candidates_of_ladder(const fs::path& folder, const json& ladder) {
    std::vector<Candidate> found;
    const json& steps = ladder.at("steps");
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const fs::path file = folder / fmt::format("step_{}", i) / "model.json";
        if (!fs::exists(file)) continue;
        found.push_back({file,
                         fmt::format("Step {}: {}", i, with_words(steps[i].at("effects"))),
                         ladder.at("held_out_probes").empty()
                             ? "fitted again at this step of the ladder"
                             : "fitted again at this step of the ladder, as ladder.json judges it",
                         {{"rms_mm", steps[i].at("rms_mm")}, {"held_out_rms_mm", steps[i].at("held_out_rms_mm")}}});
    }
    found.push_back({folder / "model.json", "Result: " + with_words(steps.at(steps.size() - 1).at("effects")),
                     "fitted to all probes"});
    return found;
}

std::vector<Candidate> candidates_in(const fs::path& input) {
    if (!fs::exists(input)) {
        throw IoError(fmt::format("{}: does not exist; give a model.json, a folder of identify or improve, or a run",
                                  input.string()));
    }
    if (!fs::is_directory(input)) {
        if (mesh::is_body_file(input))
            throw InvalidInput(fmt::format(
                "{0}: is a body without a model; 'palpate run {0}' makes one, and 'palpate play {0} --pick' sets it up",
                input.string()));
        return {{input, "The model", ""}};
    }
    if (const fs::path ladder = input / "ladder.json"; fs::exists(ladder)) {
        try {
            return candidates_of_ladder(input, json_of_file(ladder));
        } catch (const json::exception& e) {
            throw InvalidInput(fmt::format("{}: is not what palpate improve writes: {}", ladder.string(), e.what()));
        }
    }
    if (fs::exists(input / "model.json")) return {{input / "model.json", "The model", "as identified"}};
    if (fs::exists(input / "run.json")) {
        std::vector<Candidate> found;
        if (fs::exists(input / "improve/ladder.json")) found = candidates_in(input / "improve");
        const bool has_steps = found.size() > 1;
        if (!has_steps) {
            found.insert(found.begin(),
                         {input / "identify/model.json", "As identified: nothing added", "fitted to all probes"});
        }
        return found;
    }
    throw InvalidInput(
        fmt::format("{}: holds no model.json and no run.json; give a model.json, a folder of identify or improve, or a "
                    "run folder",
                    input.string()));
}

/// The measurements that a run was made with; none, and a note, where they have gone.
std::optional<identify::MeasurementSet> measurements_of(const fs::path& run, std::vector<std::string>& notes) {
    if (!fs::exists(run / "case.yaml") || !fs::exists(run / "run.json")) return std::nullopt;
    try {
        const Case settings = read_case(run / "case.yaml");
        std::vector<std::string> unsaid;  // the run has said it
        return read_measurements(settings.measurements.value_or(run / "measurements"), unsaid);
    } catch (const std::exception& e) {
        notes.push_back(
            fmt::format("The measurements are not drawn: {}. --set FOLDER tells where they are now.", e.what()));
        return std::nullopt;
    }
}

bool is_of_measurement(const skeleton::EffectRecord& effect) { return !skeleton::is_body_effect(effect.name); }

bool creeps(const skeleton::EffectRecord& effect) { return skeleton::physics_of({effect}).creep.has_value(); }

/// Can it be taken off a set? Readings that were set aside are not recorded.
bool is_taken_off(const skeleton::EffectRecord& effect) {
    const auto known = identify::effect_named(effect.name);
    return is_of_measurement(effect) && known && !known->sets_readings_aside();
}

/// Does a switch of it change what is played?
bool is_played(const skeleton::EffectRecord& effect) {
    if (is_of_measurement(effect)) return is_taken_off(effect);
    return skeleton::find_known_effect(effect.name)->not_played.empty();
}

/// Sets as they are understood with each choice of a model's faults of the measurement, and with loads as they have
/// crept where it creeps: their numbers in `sets`, by the effects' names joined by commas. Outliers that were set aside
/// are not recorded: those readings stay.
json corrected_sets(const skeleton::Model& model, const identify::MeasurementSet& set, json& sets) {
    std::vector<skeleton::EffectRecord> effects;
    for (const skeleton::EffectRecord& effect : model.effects) {
        if (creeps(effect) || is_taken_off(effect)) effects.push_back(effect);
    }
    json numbers = json::object();
    for (unsigned chosen = 0; chosen < 1U << effects.size(); ++chosen) {
        identify::MeasurementSet understood = set;
        std::string names;
        for (std::size_t e = 0; e < effects.size(); ++e) {
            if (!(chosen >> e & 1U)) continue;
            understood = creeps(effects[e])
                             ? identify::as_elastic(understood, *skeleton::physics_of({effects[e]}).creep)
                             : identify::find_effect(effects[e].name)->corrected(understood, effects[e]);
            names += (names.empty() ? "" : ",") + effects[e].name;
        }
        json text = set_as_text(understood);
        const auto same = std::ranges::find(sets, text);
        numbers[names] = same - sets.begin();
        if (same == sets.end()) sets.push_back(std::move(text));
    }
    return numbers;
}

/// Can a page replay it? It knows nothing of tools that are moved, nor of displacements since a loaded state.
bool is_replayed(const identify::MeasurementSet& set) {
    return std::ranges::none_of(set.states, [](const identify::LoadState& state) {
        return !state.motions.empty() ||
               std::ranges::any_of(state.readings, [](const identify::Reading& r) { return r.since.has_value(); });
    });
}

/// What was diagnosed in a run, or null.
json diagnosis_of(const fs::path& run) {
    const fs::path file = run / "diagnose/diagnosis.json";
    return fs::exists(file) ? json_of_file(file) : json();
}

/// Markers that look swapped: the probe and time of each pair, and their numbers in the set.
json exchanged_in(const json& diagnosis, const std::optional<identify::MeasurementSet>& set) {
    json result = json::array();
    if (!set || diagnosis.is_null()) return result;
    for (json pair : diagnosis.value("exchanged_markers", json::array())) {
        for (json& id : pair["markers"])
            id = std::ranges::find(set->markers, id.get<int>(), &identify::Marker::id) - set->markers.begin();
        result.push_back(std::move(pair));
    }
    return result;
}

/// "gz = -9790 ± 20 mm/s^2". The standard deviation is of finite elements' number: where the model was given another
/// one, by a fit of its own, that number and its deviation stand beside it.
std::string effect_number_in_words(const skeleton::EffectParameter& number, const json& diagnosed) {
    const std::string unit = number.unit == "1" || number.unit.empty() ? "" : " " + number.unit;
    const bool has_sd = diagnosed.is_object() && diagnosed["value"].is_number() && diagnosed["sd"].is_number();
    if (!has_sd) return fmt::format("{} = {:.4g}{}", number.name, number.value, unit);
    const double value = diagnosed["value"], sd = diagnosed["sd"];
    const std::string known = mesh::with_sd(value, sd);
    if (std::abs(number.value - value) <= 1e-9 * std::abs(value))  // both were printed in full
        return fmt::format("{} = {}{}", number.name, known, unit);
    return fmt::format("{} = {:.4g}{} ({} in finite elements)", number.name, number.value, unit, known);
}

/// What the page says of an effect: its meaning, and its numbers. @param row of the diagnosis's ranking, or nullptr
ordered_json effect_json(const skeleton::EffectRecord& effect, const json* row) {
    const auto known = identify::effect_named(effect.name);
    constexpr std::size_t most_numbers = 10;  // of a ball, or a support; a map has hundreds, which its sentence sums up
    std::vector<std::string> numbers;
    numbers.reserve(effect.parameters.size());
    for (const skeleton::EffectParameter& parameter : effect.parameters)
        numbers.push_back(
            effect_number_in_words(parameter, row ? (*row)["parameters"].value(parameter.name, json()) : json()));
    if (known && numbers.size() > most_numbers) numbers = {known->sentence(effect)};
    return {{"name", effect.name},      {"meaning", known ? known->description().meaning : ""},
            {"numbers", numbers},       {"fault", is_of_measurement(effect)},
            {"creeps", creeps(effect)}, {"played", is_played(effect)}};
}

/// Fields of a model's file that differ from those of the first.
ordered_json difference(const ordered_json& first, const ordered_json& other) {
    ordered_json result = ordered_json::object();
    for (const auto& [key, value] : other.items()) {
        if (!first.contains(key) || first[key] != value) result[key] = value;
    }
    for (const auto& [key, value] : first.items()) {
        if (!other.contains(key)) result[key] = nullptr;  // left out again
    }
    return result;
}

}  // namespace

PlayData play_data(const fs::path& input, const fs::path& set_folder) {
    PlayData data;
    const fs::path whole = fs::absolute(input).lexically_normal();
    data.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
    const std::vector<Candidate> candidates = candidates_in(input);
    std::optional<identify::MeasurementSet> set;
    if (!set_folder.empty()) {
        set = read_measurements(set_folder, data.notes);
        identify::require_fittable(*set);
    } else if (fs::is_directory(input)) {
        set = measurements_of(input, data.notes);
    }
    json actuators = json::array();
    if (set) actuators = actuator_sliders(*set, skeleton::read_model(candidates.front().file), data.notes);
    const bool is_judged = set && !identify::is_rigged(*set);
    if (set && !is_replayed(*set)) {
        data.notes.emplace_back(
            "The set's tools and displacements since a loaded state are not played: errors are those of the run, see "
            "its report.");
        set.reset();
    }

    const json diagnosis = diagnosis_of(input);
    json sets = json::array();
    ordered_json models = ordered_json::array(), first;
    for (const Candidate& candidate : candidates) {
        const skeleton::Model model = skeleton::read_model(candidate.file);
        if (model.surface.triangles.rows() == 0)
            throw InvalidInput(candidate.file.string() + ": has no skin that could be touched; give the model one");
        skeleton::Model errors_of = model;
        if (set) std::erase_if(errors_of.effects, is_of_measurement);  // they are played on the set
        const runtime::Body body(errors_of);
        for (const std::string& notice : body.notices()) data.notes.push_back(candidate.name + ": " + notice + ".");
        ordered_json text = ordered_json::parse(mesh::read_text(candidate.file));
        ordered_json one = {{"name", candidate.name}, {"about", candidate.about}, {"told", candidate.errors}};
        one["findings"] = findings_json(model.effects, diagnosis);
        one["effects"] = ordered_json::array();
        for (const skeleton::EffectRecord& effect : model.effects)
            one["effects"].push_back(effect_json(effect, ranking_row(diagnosis, model.effects, effect)));
        if (set) one["sets"] = corrected_sets(model, *set, sets);
        one["text"] = first.is_null() ? text : difference(first, text);
        if (first.is_null()) first = std::move(text);
        models.push_back(std::move(one));
    }
    data.models = models.size();
    data.states = set ? set->states.size() : 0;

    const json where = diagnosis.is_null() ? json() : diagnosis.value("where", json());
    if (where.is_object() && diagnosis["explanation"].empty()) data.notes.push_back(where["sentence"]);

    fs::path ladder = input / "ladder.json";
    if (!fs::exists(ladder)) ladder = input / "improve/ladder.json";
    const bool has_steps = std::ranges::any_of(candidates, [](const Candidate& c) { return !c.errors.is_null(); });
    if (fs::exists(ladder) && !has_steps) {
        data.notes.push_back(
            "The models of the ladder's steps are not here: an older palpate made it. Run it again for them.");
    }
    const json held_out =
        fs::exists(ladder) ? json_of_file(ladder).value("held_out_probes", json::array()) : json::array();
    data.content = {{"name", data.name},    {"models", models},
                    {"sets", sets},         {"exchanged", exchanged_in(diagnosis, set)},
                    {"held_out", held_out}, {"actuators", actuators},
                    {"judged", is_judged},  {"notes", data.notes}};
    return data;
}

}  // namespace palpate::pipeline
