#include "pipeline/case/expectation.h"

#include <fmt/format.h>

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

std::string broken_parameter(const Expectation::Parameter& expected,
                             const std::vector<identify::PosteriorRow>& posterior) {
    const auto row =
        std::find_if(posterior.begin(), posterior.end(), [&](auto& r) { return r.parameter == expected.name; });
    if (row == posterior.end()) return fmt::format("no parameter '{}' was identified", expected.name);
    const double off = std::abs(row->mean / expected.value - 1);
    if (off <= expected.within) return {};
    return fmt::format("{} is {:.5g} {}, expected {:g} within {:.2g} %: it is off by {:.2g} %", expected.name,
                       row->mean, row->unit, expected.value, 100 * expected.within, 100 * off);
}

}  // namespace

std::vector<std::string> broken_expectations(const Expectation& expect, const json& compare,
                                             const std::vector<identify::PosteriorRow>& posterior, int spheres) {
    std::vector<std::string> broken;
    const auto at_most = [&](const std::optional<double>& bound, const json& value, const char* what) {
        if (bound && known(value) > *bound) {
            broken.push_back(fmt::format("{} is {:.4g}, expected at most {:g}", what, known(value), *bound));
        }
    };
    at_most(expect.relative_at_most, compare["error"]["relative"], "the relative error");
    at_most(expect.held_out_at_most, compare.contains("held_out") ? compare["held_out"]["relative"] : json(),
            "the relative error on held-out probes");
    if (expect.spheres_at_least && spheres < *expect.spheres_at_least) {
        broken.push_back(fmt::format("there are {} spheres, expected at least {}", spheres, *expect.spheres_at_least));
    }
    for (const auto& parameter : expect.parameters) {
        if (const std::string line = broken_parameter(parameter, posterior); !line.empty()) broken.push_back(line);
    }
    return broken;
}

}  // namespace palpate::pipeline
