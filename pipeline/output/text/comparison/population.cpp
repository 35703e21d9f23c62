#include "pipeline/output/text/comparison/population.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string interval_words(const json& interval) {
    return fmt::format("{:.4g} ({:.4g} to {:.4g})", interval["value"].get<double>(), interval["low"].get<double>(),
                       interval["high"].get<double>());
}

/// A deviation of logarithms is a share.
std::string spread_words(const json& number) {
    const json& spread = number["spread"];
    const double low = spread["low"], value = spread["value"], high = spread["high"];
    const auto percent = [](double share) {
        return share < 0.1 ? fmt::format("{:.2g}", 100 * share) : fmt::format("{:.0f}", 100 * share);
    };
    if (number["scale"] != "linear")
        return fmt::format("{}by {} % ({} to {} %)", number["scale"] == "compressibility" ? "in 1 - 2 nu " : "",
                           percent(value), percent(low), percent(high));
    return fmt::format("by {:.2g} ({:.2g} to {:.2g})", value, low, high);
}

}  // namespace

std::string title_of_number(const json& number) {
    std::string name = number["name"];
    const std::string unit = number["unit"];
    if (name == "young") name = "Young's modulus";
    if (name == "poisson") name = "Poisson's ratio";
    return unit == "1" ? name : fmt::format("{} [{}]", name, unit);
}

std::string population_in_words(const json& number) {
    std::string words = fmt::format(
        "The mean of {} specimens is {}. They differ {}, one standard deviation. Expect a next one "
        "between {:.4g} and {:.4g}.",
        number["specimens"].size(), interval_words(number["mean"]), spread_words(number),
        number["next"]["low"].get<double>(), number["next"]["high"].get<double>());
    std::vector<std::string> outlying;
    for (const json& one : number["specimens"])
        if (one["outlying"]) outlying.push_back(one["run"]);
    if (!outlying.empty()) words += fmt::format(" Unlike the others: {}.", fmt::join(outlying, ", "));
    if (!number["without"].empty())
        words +=
            fmt::format(" Not determined by: {}.", fmt::join(number["without"].get<std::vector<std::string>>(), ", "));
    return words;
}

bool is_of_single_link(const std::string& name) { return name.find(":link") != std::string::npos; }

std::string single_links_in_words(const json& population) {
    const auto links = std::ranges::count_if(population["numbers"],
                                             [](const json& number) { return is_of_single_link(number["name"]); });
    if (links == 0)
        return population["no_map"].is_null()
                   ? std::string()
                   : fmt::format("Single links are not pooled, as they do not correspond: {}.",
                                 population["no_map"].get<std::string>());
    return fmt::format(
        "{} stiffnesses of single links, at corresponding places of all skeletons, are in population.json.", links);
}

std::string population_tables(const json& population) {
    std::string text;
    for (const json& number : population["numbers"]) {
        if (is_of_single_link(number["name"])) continue;
        std::size_t width = 8;
        for (const json& one : number["specimens"]) width = std::max(width, one["run"].get<std::string>().size());
        text += fmt::format("{}, by {}\n{}\n", title_of_number(number), number["of"].get<std::string>(),
                            population_in_words(number));
        text += fmt::format("  {:<{}}  {:<34}  {}\n", "Specimen", width, "by itself (95 %)", "among the others");
        for (const json& one : number["specimens"]) {
            text += fmt::format(
                "  {:<{}}  {:<34}  {}{}\n", one["run"].get<std::string>(), width, interval_words(one["own"]),
                interval_words(one["pooled"]),
                one["outlying"] ? fmt::format("  unlike the others (p = {:.2g})", one["p_value"].get<double>()) : "");
        }
        text += "\n";
    }
    const std::string links = single_links_in_words(population);
    return links.empty() ? text : text + links + "\n";
}

}  // namespace palpate::pipeline
