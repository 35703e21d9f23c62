#include "pipeline/output/text/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "pipeline/output/ranking_row.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// What an effect comes to here, or its name where that is not known. `alone`: with its probability against the other
/// single ones, which says nothing of several together.
std::string sentence_of(const json& candidate, bool alone) {
    const std::string fallback = "The effect " + candidate["effect"].get<std::string>() + " is missing.";
    const std::string sentence = candidate.value("sentence", fallback);
    if (!alone) return sentence;
    return with_aside(sentence, "probability " + probability_in_words(candidate["probability"].get<double>()));
}

/// How much less likely than the first the second is.
std::string how_likely(double log_ratio) {
    constexpr double ruled_out = 1e-3;  // below it the number itself says nothing more
    if (log_ratio < std::log(ruled_out)) return "less than a thousandth as likely";
    return fmt::format("{:.2g} times as likely", std::exp(log_ratio));
}

/// A fit that leaves less and is not claimed: what speaks against it are its parameters.
std::string why_closer_is_not_likelier(const json& first, const json& second) {
    const std::size_t own = first["parameters"].size(), others = second["parameters"].size();
    const char* rms = keys_of(first).fitted;
    const bool fits_closer = first["rms_mm"].is_number() && second["rms_mm"].is_number() &&
                             second[rms].get<double>() < first[rms].get<double>();
    if (!fits_closer || others <= own) return {};
    return fmt::format(". It leaves {} rms, but with {} parameters instead of {}, which the Bayes factor penalises",
                       rms_in_words(second), others, own);
}

/// Are single readings that were set aside all that was named? They have no fit of their own: the baseline is without
/// them.
bool is_of_single_readings(const json& diagnosis) {
    const json& ranking = diagnosis["ranking"];
    if (diagnosis["explanation"].size() != 1 || ranking.empty()) return false;
    return ranking.front()["kind"] == "measurement" && ranking.front()["rms_mm"].is_null();
}

std::string without_it(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    // A skeleton has no Young's modulus.
    const char* model = baseline.value("young_mpa", json()).is_number() ? "finite-element model" : "model";
    if (is_of_single_readings(diagnosis))
        return fmt::format(" Without these readings the rms error of the {} is {}, {}.", model, rms_in_words(baseline),
                           in_sigmas(baseline["whitened_rms"]));
    std::string text = fmt::format(" Without {} the rms error of the {} is {}",
                                   diagnosis["explanation"].size() > 1 ? "them" : "it", model, rms_in_words(baseline));
    if (baseline.contains("load_exponent")) text += and_under_load(baseline["load_exponent"]);
    return text + ".";
}

/// How each probe is forecast by a fit to the others, without the effect and with it.
std::string forecast_words(const json& before, const json& after, const char* effects) {
    const std::string then = held_out_rms_in_words(before), now = held_out_rms_in_words(after);
    if (then.empty() || now.empty()) return {};
    const char* held_out = keys_of(before).held_out;
    std::string why;
    if (after[held_out].get<double>() >= before[held_out].get<double>()) {
        // What a fault of the measurement is in another probe is not known, and its normalised error allows for that.
        const json normalised = after.value("held_out_whitened_rms", json()),
                   normalised_before = before.value("held_out_whitened_rms", json());
        const bool falls = normalised.is_number() && normalised_before.is_number() && normalised < normalised_before;
        why = falls && after.value("kind", "") == "measurement"
                  ? fmt::format(
                        ", as the fault is not known in a probe left out; normalised by its spread and the noise, "
                        "the error falls from {:.3g} to {:.3g}",
                        normalised_before.get<double>(), normalised.get<double>())
                  : ": from so few probes the prediction does not improve";
    }
    return fmt::format(
        " Probes left out of the fit one at a time are predicted to within {} rms, without {} to within {}{}.", now,
        effects, then, why);
}

/// What the stiffness comes to with the explanation, and was taken for without it.
std::string material_words(const json& diagnosis, const char* effects) {
    const json explained = diagnosis.value("explained", json());
    if (!explained.is_object()) return {};
    return fmt::format(" The fit gives {}; without {}, {}.", material_in_words(explained), effects,
                       material_in_words(diagnosis["baseline"]));
}

/// What is left with the explanation, which is `what` done with `effects` ("it", "them"). @param fit their errors
std::string drop_words(const json& diagnosis, const json& fit, const char* what, const char* effects) {
    if (!fit.is_object() || !fit["rms_mm"].is_number()) return {};
    // A fit weighs what the noise and unknown contacts cover less, and may leave more there.
    const char* rms = keys_of(fit).fitted;
    const bool falls = fit[rms].get<double>() < diagnosis["baseline"].value(rms, 0.0);
    return fmt::format(" {} {} {}, {}.", what, falls ? "lowers the error to" : "leaves an error of", rms_in_words(fit),
                       in_sigmas(fit["whitened_rms"])) +
           forecast_words(diagnosis["baseline"], fit, effects) + material_words(diagnosis, effects);
}

std::string runner_up(const json& diagnosis) {
    const json& ranking = diagnosis["ranking"];
    if (ranking.size() < 2 || !ranking[1]["log_bayes_factor"].is_number()) return {};
    const double behind = ranking[1]["log_bayes_factor"].get<double>() - ranking[0]["log_bayes_factor"].get<double>();
    const std::string name = ranking[1]["effect"];
    if (ranking[1].contains("objection"))
        return fmt::format(" Runner-up: {}, not claimed: {}.", name, ranking[1]["objection"].get<std::string>());
    return fmt::format(" Runner-up: {}, {}{}.", name, how_likely(behind),
                       why_closer_is_not_likelier(ranking[0], ranking[1]));
}

std::string missing_effect(const json& diagnosis) {
    const auto names = diagnosis["explanation"].get<std::vector<std::string>>();
    std::string text = names.size() > 1 ? fmt::format("Missing together: {}.", listed(names)) : "";
    for (auto name = names.begin(); name != names.end(); ++name) {
        if (const json* candidate = ranking_row(diagnosis, *name, std::count(names.begin(), name, *name))) {
            if (!text.empty()) text += " ";
            text += sentence_of(*candidate, names.size() == 1);
        }
    }
    text += without_it(diagnosis);
    if (names.size() > 1) {
        text += drop_words(diagnosis, diagnosis.value("explained", json()), "Taking them into account", "them");
    } else if (const json* candidate = ranking_row(diagnosis, names.front())) {
        const char* what = (*candidate)["kind"] == "body" ? "Adding it" : "Correcting for it";
        text += drop_words(diagnosis, *candidate, what, "it") + runner_up(diagnosis);
    }
    return text;
}

std::string ambiguous(const json& diagnosis) {
    std::vector<std::string> names;
    std::string each;
    for (const json& candidate : diagnosis["ranking"]) {
        if (names.size() == 2 || !candidate["rms_mm"].is_number()) continue;
        names.push_back(candidate["effect"]);
        each += fmt::format(" {} It would leave {} rms, {}.", sentence_of(candidate, true), rms_in_words(candidate),
                            in_sigmas(candidate["whitened_rms"]));
    }
    std::string text = fmt::format("An effect is missing, but these measurements cannot decide which: {}.",
                                   fmt::format("{}", fmt::join(names, " or ")));
    return text + each;
}

std::string unexplained(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    std::string text = fmt::format("An effect outside the catalogue is missing: the model error is {} rms, {}",
                                   rms_in_words(baseline), in_sigmas(baseline["whitened_rms"]));
    if (baseline.contains("load_exponent")) {
        text += and_under_load(baseline["load_exponent"]);
    }
    text += ".";
    const json& ranking = diagnosis["ranking"];
    if (ranking.empty() || !ranking[0]["whitened_rms"].is_number()) return text;
    text += fmt::format(" The nearest is {}, which leaves {} rms, {}.", ranking[0]["effect"].get<std::string>(),
                        rms_in_words(ranking[0]), in_sigmas(ranking[0]["whitened_rms"]));
    if (ranking[0].contains("objection")) {
        text += " It is not claimed: " + ranking[0]["objection"].get<std::string>() + ".";
    }
    return text;
}

std::string adequate(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    std::string text = fmt::format("The model is adequate for these measurements: residual {} rms, {}.",
                                   rms_in_words(baseline), in_sigmas(baseline["whitened_rms"]));
    const json& ranking = diagnosis["ranking"];
    if (ranking.empty()) return text;
    const json& bayes = ranking[0]["log_bayes_factor"];
    if (!bayes.is_number()) return text;
    text += fmt::format(" The most probable effect, {}, has a ln Bayes factor of {:.1f}",
                        ranking[0]["effect"].get<std::string>(), bayes.get<double>());
    if (!ranking[0].contains("objection")) return text + "; 10 would be a claim.";
    return text + fmt::format(" and is no claim: {}.", ranking[0]["objection"].get<std::string>());
}

/// Where it is, without assuming a specific effect: what an effect that is named need not repeat.
std::string located(const json& diagnosis) {
    const json where = diagnosis.value("where", json());
    if (!where.is_object() || diagnosis["verdict"] == "missing-effect") return {};
    return " Without assuming a specific effect: " + where["sentence"].get<std::string>();
}

std::string next_probe(const json& probe) {
    if (!probe.is_object()) return {};
    std::string text = " The next probe " + probe["why"].get<std::string>();
    while (text.ends_with('.')) text.pop_back();
    if (probe.contains("contact")) {
        text += fmt::format("; press with {} N at {} mm", place(probe["force"]), place(probe["contact"]));
    }
    return text + ".";
}

}  // namespace

std::string diagnosis_in_words(const json& diagnosis) {
    const std::string verdict = diagnosis["verdict"];
    const std::string text = verdict == "missing-effect" ? missing_effect(diagnosis)
                             : verdict == "ambiguous"    ? ambiguous(diagnosis)
                             : verdict == "unexplained"  ? unexplained(diagnosis)
                                                         : adequate(diagnosis);
    // An effect that is named explains what the baseline does not.
    const json unexplained_share =
        verdict == "missing-effect" ? json() : diagnosis["baseline"].value("relative", json());
    return text + located(diagnosis) + if_it_explains_nothing(unexplained_share) + next_probe(diagnosis["next_probe"]);
}

}  // namespace palpate::pipeline
