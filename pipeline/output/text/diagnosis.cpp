#include "pipeline/output/text/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr double worth_telling = -690;  // ln of a share below which "10^-300" says no more

const json* find(const json& ranking, const std::string& effect) {
    const auto found = std::ranges::find_if(ranking, [&](const json& c) { return c["effect"] == effect; });
    return found == ranking.end() ? nullptr : &*found;
}

/// What an effect comes to here, or its name where that is not known. `alone`: with its probability against the other
/// single ones, which says nothing of several together.
std::string sentence_of(const json& candidate, bool alone) {
    const std::string fallback = "The effect " + candidate["effect"].get<std::string>() + " is missing.";
    const std::string sentence = candidate.value("sentence", fallback);
    if (!alone) return sentence;
    return with_aside(sentence, fmt::format("probability {:.2f}", candidate["probability"].get<double>()));
}

/// How much less likely one candidate is than another: "0.3 times" or "10^-54 times".
std::string how_likely(double log_ratio) {
    if (log_ratio < worth_telling) return "less than 10^-300 times";
    if (log_ratio < std::log(1e-3)) return fmt::format("10^{:.0f} times", log_ratio / std::log(10.0));
    return fmt::format("{:.2g} times", std::exp(log_ratio));
}

std::string without_it(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    std::string text = fmt::format(" Without it the model errs by {:.3g} mm rms", baseline["rms_mm"].get<double>());
    if (baseline.contains("load_exponent")) {
        text += ", and " + baseline["load_exponent"]["words"].get<std::string>();
    }
    return text + ".";
}

std::string drop_words(const json& diagnosis, const json& candidate) {
    if (!candidate["rms_mm"].is_number()) return {};
    std::string text = fmt::format(" {} it should lower the error from {:.3g} to {:.3g} mm rms",
                                   candidate["kind"] == "body" ? "Adding" : "Correcting for",
                                   diagnosis["baseline"]["rms_mm"].get<double>(), candidate["rms_mm"].get<double>());
    if (candidate["held_out_rms_mm"].is_number()) {
        text += fmt::format(" ({:.3g} on probes left out)", candidate["held_out_rms_mm"].get<double>());
    }
    return text + ", " + in_sigmas(candidate["whitened_rms"]) + ".";
}

std::string runner_up(const json& diagnosis) {
    const json& ranking = diagnosis["ranking"];
    if (ranking.size() < 2 || !ranking[1]["log_bayes_factor"].is_number()) return {};
    const double behind = ranking[1]["log_bayes_factor"].get<double>() - ranking[0]["log_bayes_factor"].get<double>();
    const std::string name = ranking[1]["effect"];
    if (ranking[1].contains("objection"))
        return fmt::format(" Runner-up: {}, not claimed: {}.", name, ranking[1]["objection"].get<std::string>());
    return fmt::format(" Runner-up: {}, {} as likely.", name, how_likely(behind));
}

std::string missing_effect(const json& diagnosis) {
    const auto names = diagnosis["explanation"].get<std::vector<std::string>>();
    std::string text = names.size() > 1 ? fmt::format("Missing together: {}.", listed(names)) : "";
    for (const std::string& name : names) {
        if (const json* candidate = find(diagnosis["ranking"], name)) {
            if (!text.empty()) text += " ";
            text += sentence_of(*candidate, names.size() == 1);
        }
    }
    text += without_it(diagnosis);
    if (names.size() == 1) {
        if (const json* candidate = find(diagnosis["ranking"], names.front())) {
            text += drop_words(diagnosis, *candidate) + runner_up(diagnosis);
        }
    }
    return text;
}

std::string ambiguous(const json& diagnosis) {
    std::vector<std::string> names;
    std::string each;
    for (const json& candidate : diagnosis["ranking"]) {
        if (names.size() == 2 || !candidate["rms_mm"].is_number()) continue;
        names.push_back(candidate["effect"]);
        each += fmt::format(" {} It would leave {:.3g} mm rms, {}.", sentence_of(candidate, true),
                            candidate["rms_mm"].get<double>(), in_sigmas(candidate["whitened_rms"]));
    }
    std::string text = fmt::format("An effect is missing, but these measurements cannot decide which: {}.",
                                   fmt::format("{}", fmt::join(names, " or ")));
    return text + each;
}

std::string unexplained(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    std::string text = fmt::format("An effect outside the catalogue is missing: the model error is {:.3g} mm rms, {}",
                                   baseline["rms_mm"].get<double>(), in_sigmas(baseline["whitened_rms"]));
    if (baseline.contains("load_exponent")) {
        text += ", and " + baseline["load_exponent"]["words"].get<std::string>();
    }
    text += ".";
    const json& ranking = diagnosis["ranking"];
    if (ranking.empty() || !ranking[0]["whitened_rms"].is_number()) return text;
    text += fmt::format(" The nearest is {}, which leaves {:.3g} mm rms, {}.", ranking[0]["effect"].get<std::string>(),
                        ranking[0]["rms_mm"].get<double>(), in_sigmas(ranking[0]["whitened_rms"]));
    if (ranking[0].contains("objection")) {
        text += " It is not claimed: " + ranking[0]["objection"].get<std::string>() + ".";
    }
    return text;
}

std::string adequate(const json& diagnosis) {
    const json& baseline = diagnosis["baseline"];
    std::string text = fmt::format("The model is adequate for these measurements: residual {:.3g} mm rms, {}.",
                                   baseline["rms_mm"].get<double>(), in_sigmas(baseline["whitened_rms"]));
    const json& ranking = diagnosis["ranking"];
    if (ranking.empty()) return text;
    const json& bayes = ranking[0]["log_bayes_factor"];
    if (!bayes.is_number()) return text;
    text += fmt::format(" The most probable effect, {}, has a ln Bayes factor of {:.1f}",
                        ranking[0]["effect"].get<std::string>(), bayes.get<double>());
    if (!ranking[0].contains("objection")) return text + "; 10 would be a claim.";
    return text + fmt::format(" and is no claim: {}.", ranking[0]["objection"].get<std::string>());
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
    return text + if_it_explains_nothing(diagnosis["baseline"].value("relative", json())) +
           next_probe(diagnosis["next_probe"]);
}

}  // namespace palpate::pipeline
