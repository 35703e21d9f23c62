#include "pipeline/output/damping.h"

#include <fmt/format.h>

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json to_json(const identify::PosteriorSummary& known) {
    return {{"mean", known.mean}, {"sd", known.sd},     {"q025", known.q025},
            {"q50", known.q50},   {"q975", known.q975}, {"informed", known.informed}};
}

}  // namespace

std::string interval_in_words(const json& known) {
    return fmt::format("{:.3g} ({:.3g} to {:.3g})", known["q50"].get<double>(), known["q025"].get<double>(),
                       known["q975"].get<double>());
}

json to_json(const identify::DampingResult& found) {
    json modes = json::array(), evidence = json::object();
    for (const identify::DampedMode& mode : found.modes) {
        modes.push_back({{"frequency_hz", mode.frequency},
                         {"measured_hz", to_json(mode.measured)},
                         {"ratio", to_json(mode.ratio)},
                         {"played_ratio", mode.played},
                         {"share", mode.share}});
    }
    for (std::size_t law = 0; law < found.log_evidence.size(); ++law)
        evidence[identify::damping_law_names[law]] = found.log_evidence[law];
    return {{"law", identify::damping_law_names[static_cast<std::size_t>(found.law)]},
            {"law_is_told", found.law_is_identified},
            {"mass", found.damping.alpha},
            {"stiffness", found.damping.beta},
            {"ratio", to_json(found.ratio)},
            {"speed", to_json(found.speed)},
            {"log_evidence", evidence},
            {"modes", modes},
            {"rms_mm", found.rms},
            {"displacement_mm", found.displacement},
            {"masses_times", found.mass},
            {"readings", found.readings},
            {"independent_readings", found.independent},
            {"effective_samples", found.effective_samples},
            {"notes", found.notes}};
}

std::string damping_csv(const identify::DampingResult& found) {
    std::string text = "probe,marker,axis,time,measured,played\n";
    for (const identify::Trace& trace : found.traces) {
        for (std::size_t i = 0; i < trace.time.size(); ++i) {
            text += fmt::format("{},{},{},{},{:.6g},{:.6g}\n", trace.probe, trace.marker, "xyz"[trace.axis],
                                trace.time[i], trace.measured[i], trace.played[i]);
        }
    }
    return text;
}

std::string how_it_goes(const json& damping) {
    if (!damping["law_is_told"].get<bool>())
        return "its frequency dependence is not identified; that takes vibrations at well separated frequencies";
    const std::string law = damping["law"];
    if (law == "stiffness") return "it grows with frequency, as links resist the rates of their strains";
    return law == "mass" ? "it falls with frequency, as masses resist their velocities" : "by mass and by stiffness";
}

std::string damping_in_words(const json& damping) {
    std::string text = fmt::format(
        "  Damping: ratio {} of the slowest vibration that was seen; {}.\n"
        "  Motion of {:.3g} mm rms is followed to {:.2g} mm; the body vibrates {} times as fast as the model.\n"
        "  {:>10} {:>26} {:>28} {:>8} {:>8}\n",
        interval_in_words(damping["modes"][0]["ratio"]), how_it_goes(damping), damping["displacement_mm"].get<double>(),
        damping["rms_mm"].get<double>(), interval_in_words(damping["speed"]), "model [Hz]", "measured [Hz]",
        "damping ratio", "played", "share");
    for (const json& mode : damping["modes"]) {
        text += fmt::format("  {:>10.3g} {:>26} {:>28} {:>8.3g} {:>6.1f} %{}\n", mode["frequency_hz"].get<double>(),
                            interval_in_words(mode["measured_hz"]), interval_in_words(mode["ratio"]),
                            mode["played_ratio"].get<double>(), 100 * mode["share"].get<double>(),
                            mode["ratio"]["informed"].get<bool>() ? "" : "  not determined by the data");
    }
    for (const json& note : damping["notes"]) text += "  " + note.get<std::string>() + "\n";
    return text;
}

}  // namespace palpate::pipeline
