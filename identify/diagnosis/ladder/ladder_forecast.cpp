#include "identify/diagnosis/ladder/ladder_forecast.h"

#include <fmt/format.h>

#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

/// How many times as far off on held-out probes a step is as another one: rms of the ratios of positions and of forces,
/// as far as these are measured. 0 where nothing is held out.
double forecast_ratio(const StepError& then, const StepError& since) {
    double squares = 0;
    int kinds = 0;
    const auto add = [&](double before, double now) {
        if (!(before > 0)) return;
        squares += (now / before) * (now / before);
        ++kinds;
    };
    add(then.held_out_rms_mm, since.held_out_rms_mm);
    add(then.held_out_rms_n, since.held_out_rms_n);
    return kinds > 0 ? std::sqrt(squares / kinds) : 0;
}

std::string forecast_in_words(const StepError& step) {
    const bool positions = step.held_out_rms_mm > 0, forces = !std::isnan(step.held_out_rms_n);
    const std::string text = positions || !forces ? fmt::format("{:.3g} mm", step.held_out_rms_mm) : "";
    if (!forces) return text;
    return text + (text.empty() ? "" : " and ") + fmt::format("{:.3g} N", step.held_out_rms_n);
}

}  // namespace

std::optional<std::string> what_is_worse(const LadderStep& before, const LadderStep& now, double most) {
    const auto is_worse = [&](const StepError& then, const StepError& since) {
        return forecast_ratio(then, since) >= most;
    };
    const auto in_words = [](const char* what, const StepError& then, const StepError& since) {
        return fmt::format("with it the {} is off by {} on held-out probes, {} without it", what,
                           forecast_in_words(since), forecast_in_words(then));
    };
    const bool has_body = now.reference && before.reference;
    if (has_body && is_worse(*before.reference, *now.reference))
        return in_words("finite-element model", *before.reference, *now.reference);
    if (!is_worse(before.skeleton, now.skeleton)) return {};
    std::string text = in_words("skeleton", before.skeleton, now.skeleton);
    if (has_body)
        text += fmt::format(" (finite elements: {} with it, {} without)", forecast_in_words(*now.reference),
                            forecast_in_words(*before.reference));
    return text;
}

bool is_forecast_by_its_spread(const std::string& effect, const LadderStep& before, const LadderStep& now) {
    return !find_effect(effect)->is_of_body() && before.reference && now.reference &&
           now.reference->held_out_whitened_rms < before.reference->held_out_whitened_rms;
}

}  // namespace palpate::identify
