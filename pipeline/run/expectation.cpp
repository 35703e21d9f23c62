#include "pipeline/run/expectation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// What is unknown keeps no promise.
double known(const json& value) {
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

/// A stiffness of the posterior by its name, or "damping_ratio" of the slowest vibration that was seen.
std::string broken_parameter(const Expectation::Parameter& expected, const RunResults& results) {
    identify::PosteriorRow row;
    const auto found = std::ranges::find(results.posterior, expected.name, &identify::PosteriorRow::parameter);
    if (found != results.posterior.end()) {
        row = *found;
    } else if (expected.name == "damping_ratio" && !results.damping.is_null()) {
        row.mean = results.damping["modes"][0]["ratio"]["q50"];
    } else {
        return fmt::format("no parameter '{}' was identified", expected.name);
    }
    const double off = std::abs(row.mean / expected.value - 1);
    if (off <= expected.within) return {};
    return fmt::format("{} is {:.5g} {}, expected {:g} within {:.2g} %: it is off by {:.2g} %", expected.name, row.mean,
                       row.unit, expected.value, 100 * expected.within, 100 * off);
}

std::string broken_modes(int expected, const json& modes) {
    constexpr double least = 0.05;  // probability
    const auto found = std::ranges::count_if(modes, [](const json& mode) { return mode["probability"] >= least; });
    return found == expected ? "" : fmt::format("the posterior has {} modes, expected {}", found, expected);
}

std::string broken_verdict(const std::string& expected, const json& diagnosis) {
    if (diagnosis.is_null()) return fmt::format("there is no diagnosis, expected the verdict '{}'", expected);
    const std::string verdict = diagnosis["verdict"];
    return verdict == expected ? "" : fmt::format("the verdict is '{}', expected '{}'", verdict, expected);
}

std::string broken_explanation(std::vector<std::string> expected, const json& diagnosis) {
    std::vector<std::string> named;
    if (!diagnosis.is_null()) named = diagnosis["explanation"].get<std::vector<std::string>>();
    std::ranges::sort(named);
    std::ranges::sort(expected);
    if (named == expected) return {};
    return fmt::format("the explanation is [{}], expected [{}]", fmt::join(named, ", "), fmt::join(expected, ", "));
}

}  // namespace

std::vector<std::string> broken_expectations(const Expectation& expect, const RunResults& results) {
    const json& compare = results.compare;
    std::vector<std::string> broken;
    const auto at_most = [&](const std::optional<double>& bound, const json& value, const char* what) {
        if (bound && known(value) > *bound) {
            broken.push_back(fmt::format("{} is {:.4g}, expected at most {:g}", what, known(value), *bound));
        }
    };
    at_most(expect.relative_at_most, compare["error"]["relative"], "the relative error");
    at_most(expect.held_out_at_most, compare.contains("held_out") ? compare["held_out"]["relative"] : json(),
            "the relative error on held-out probes");
    const json& last = results.ladder.is_null() ? compare["error"] : results.ladder["steps"].back();
    at_most(expect.rms_at_most_mm, last["rms_mm"], "the error in mm rms, with all effects in,");
    if (expect.spheres_at_least && results.spheres < *expect.spheres_at_least) {
        broken.push_back(
            fmt::format("there are {} spheres, expected at least {}", results.spheres, *expect.spheres_at_least));
    }
    const auto keep = [&](const std::string& line) {
        if (!line.empty()) broken.push_back(line);
    };
    for (const auto& parameter : expect.parameters) keep(broken_parameter(parameter, results));
    if (expect.modes) keep(broken_modes(*expect.modes, results.modes));
    if (expect.verdict) keep(broken_verdict(*expect.verdict, results.diagnosis));
    if (expect.explanation) keep(broken_explanation(*expect.explanation, results.diagnosis));
    return broken;
}

}  // namespace palpate::pipeline
