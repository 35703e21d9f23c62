#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mesh/errors.h"
#include "pipeline/case/json_file.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/describe/describe.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/words.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Description describe_model(const fs::path& file) {
    const skeleton::Model model = skeleton::read_model(file);
    const auto held = std::ranges::count_if(model.spheres, [](auto& s) { return s.held; });
    Description description{.kind = "a model of spheres and links, '" + model.name + "'", .lines = {}, .next = {}};
    description.lines.push_back(fmt::format("{} spheres, {} of them held; {} links; a skin of {} vertices",
                                            model.spheres.size(), held, model.links.size(), model.skin.size()));
    std::vector<std::string> effects;
    for (const skeleton::EffectRecord& effect : model.effects) effects.push_back(effect.name);
    description.lines.push_back(effects.empty() ? "no effects beyond the links" : "with " + listed(effects));
    for (std::size_t k = 0; !model.links.empty() && k < static_cast<std::size_t>(model.links.front().stiffness.size());
         ++k) {
        double low = 1e300, high = 0;
        for (const skeleton::Link& link : model.links) {
            low = std::min(low, link.stiffness[static_cast<Eigen::Index>(k)]);
            high = std::max(high, link.stiffness[static_cast<Eigen::Index>(k)]);
        }
        description.lines.push_back(fmt::format("{} {:.3g} to {:.3g} {}", skeleton::stiffness_names[k], low, high,
                                                skeleton::stiffness_units[k]));
    }
    for (const auto& [what, text] : model.provenance) description.lines.push_back(what + ": " + text);
    description.next = "palpate simulate " + file.string() + " --probes probes.csv -o played";
    return description;
}

Description describe_comparison(const fs::path& file) {
    return {.kind = "a comparison of a model with measurements",
            .lines = {compare_in_words(json_of_file(file))},
            .next = {}};
}

Description describe_diagnosis(const fs::path& file) {
    return {.kind = "a diagnosis: what a model lacks", .lines = {diagnosis_in_words(json_of_file(file))}, .next = {}};
}

Description describe_ladder(const fs::path& file) {
    return {.kind = "a ladder: the error before and after effects were added",
            .lines = {ladder_in_words(json_of_file(file))},
            .next = "palpate info " + (file.parent_path() / "model.json").string()};
}

Description describe_quality(const fs::path& file) {
    Description description{.kind = "errors of skeletons over their number of spheres", .lines = {}, .next = {}};
    for (const json& step : json_of_file(file)["rungs"]) {
        description.lines.push_back(fmt::format("{} spheres: {:.2f} % rms", step["spheres"].get<int>(),
                                                100 * step["error"]["rms"].get<double>()));
    }
    return description;
}

}  // namespace

Description describe_json(const fs::path& file) {
    static const std::map<std::string, std::function<Description(const fs::path&)>> kinds{
        {"palpate-model/1", describe_model},
        {"palpate-comparison/1", describe_comparison},
        {"palpate-diagnosis/1", describe_diagnosis},
        {"palpate-ladder/1", describe_ladder},
        {"palpate-quality/1", describe_quality}};
    const json content = json_of_file(file);
    if (content.is_object() && content.value("program", "") == "palpate") return describe_run(file.parent_path());
    const std::string format = content.is_object() ? content.value("format", "") : "";
    const auto found = kinds.find(format);
    if (found == kinds.end()) {
        std::vector<std::string> known;
        known.reserve(kinds.size());
        for (const auto& [name, ignored] : kinds) known.push_back(name);
        throw InvalidInput(
            fmt::format("{}: its \"format\" is '{}'; known are {}", file.string(), format, listed(known)));
    }
    return found->second(file);
}

namespace {

/// What was found, as the run itself told it: of a model that effects were added to, the one that came of it.
std::vector<std::string> findings_of_run(const fs::path& folder) {
    const json ladder =
        fs::exists(folder / "improve/ladder.json") ? json_of_file(folder / "improve/ladder.json") : json();
    const auto added = ladder.is_null() ? std::vector<std::string>{}
                                        : ladder["steps"].back()["effects"].get<std::vector<std::string>>();
    std::vector<std::string> lines;
    if (fs::exists(folder / "diagnose/diagnosis.json"))
        lines.push_back(diagnosis_in_words(json_of_file(folder / "diagnose/diagnosis.json")));
    if (!added.empty() && fs::exists(folder / "improve/compare.json"))
        lines.push_back(
            compare_in_words(json_of_file(folder / "improve/compare.json"),
                             fmt::format("The real-time model with {}, fitted to all probes,", listed(added))));
    else if (fs::exists(folder / "compare/compare.json"))
        lines.push_back(compare_in_words(json_of_file(folder / "compare/compare.json")));
    if (!ladder.is_null()) lines.push_back(ladder_in_words(ladder));
    return lines;
}

}  // namespace

Description describe_run(const fs::path& folder) {
    const json record = json_of_file(folder / "run.json");
    Description description{.kind = "a run folder, made by palpate " + record.value("version", ""),
                            .lines = findings_of_run(folder),
                            .next = {}};
    for (const auto& [stage, figures] : record["stages"].items()) {
        description.lines.push_back(fmt::format("{:<13} {:.1f} s, {:.0f} MB", stage, figures["seconds"].get<double>(),
                                                figures["peak_memory_mb"].get<double>()));
    }
    const bool whole = fs::exists(folder / "report.html");
    description.lines.push_back(whole ? "Report: " + (folder / "report.html").string() : "It is not finished.");
    description.next = whole ? "paraview --script=" + (folder / "view.py").string()
                             : "palpate run " + (folder / "case.yaml").string() + " -o " + folder.string();
    return description;
}

}  // namespace palpate::pipeline
