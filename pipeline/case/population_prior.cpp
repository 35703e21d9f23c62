#include "pipeline/case/population_prior.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "identify/numerics/summaries.h"
#include "mesh/errors.h"
#include "pipeline/case/json_file.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Of a number on the scale on which it is normal. None: that of an effect, or one that may be negative.
std::optional<identify::InformativePrior> prior_of(const json& number) {
    const std::string name = number.at("name"), scale = number.at("scale");
    if (scale == "linear") return std::nullopt;
    const bool is_ratio = scale == "compressibility";
    const bool is_effect_s = number.at("of") == "finite elements" && name != "young" && name != "poisson";
    if (is_effect_s) return std::nullopt;
    const auto on_scale = [&](const char* which) {
        const double x = number.at("next").at(which);
        return std::log(is_ratio ? 1 - 2 * x : x);
    };
    const double sd = std::abs(on_scale("high") - on_scale("low")) / (2 * identify::sds_of_95_percent);
    return identify::InformativePrior{is_ratio ? "compressibility" : name, on_scale("value"), sd};
}

}  // namespace

json priors_json(const std::vector<identify::InformativePrior>& priors) {
    json key = json::object();
    for (const identify::InformativePrior& one : priors) key[one.parameter] = {one.mean, one.sd};
    return key;
}

std::vector<identify::InformativePrior> read_population_prior(const fs::path& population) {
    const fs::path file = fs::is_regular_file(population) ? population : population / "population.json";
    if (!fs::exists(file))
        throw InvalidInput(fmt::format("{}: there is no such file; 'palpate pool RUN... -o {}' writes it",
                                       file.string(),
                                       file.has_parent_path() ? file.parent_path().string() : "POPULATION"));
    const json read = json_of_file(file);
    if (!read.is_object() || read.value("format", "") != "palpate-population/1")
        throw InvalidInput(
            fmt::format("{}: is no population; 'palpate pool RUN... -o POPULATION' writes one", file.string()));
    std::vector<identify::InformativePrior> result;
    try {
        for (const json& number : read.at("numbers")) {
            const auto own = prior_of(number);
            if (own && own->sd > 0 && std::isfinite(own->mean) && std::isfinite(own->sd)) result.push_back(*own);
        }
    } catch (const json::exception& e) {
        throw InvalidInput(fmt::format("{}: is not as 'palpate pool' writes it: {}", file.string(), e.what()));
    }
    if (result.empty())
        throw InvalidInput(fmt::format(
            "{}: tells no stiffness that a specimen's prior could be; pool runs whose measurements inform some",
            file.string()));
    return result;
}

}  // namespace palpate::pipeline
