#include "pipeline/analysis/forecast/uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "identify/inference/particles/resampling.h"
#include "identify/inference/problem/parameters.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/particles.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

identify::Scope scope_of(const std::vector<std::string>& names) {
    const auto any_of = [&](const char* part) {
        return std::ranges::any_of(names, [&](const std::string& n) { return n.find(part) != std::string::npos; });
    };
    if (any_of(":link") || any_of(":sphere")) return identify::Scope::links;
    return any_of(":zone") ? identify::Scope::zones : identify::Scope::uniform;
}

/// Of each column of the particles, the parameter of the model. @throws InvalidInput where it has none of that name.
std::vector<int> places_of(const std::vector<std::string>& names, const identify::Parameters& parameters,
                           const fs::path& file) {
    std::vector<int> places;
    for (const std::string& name : names) {
        const auto found = std::ranges::find(parameters.list, name, &identify::Parameter::name);
        if (found == parameters.list.end()) {
            throw InvalidInput(fmt::format(
                "{}: '{}' is no stiffness of the model; these are particles of another one. Name the folder of its "
                "own identification (--posterior), or do without intervals (--draws 0)",
                file.string(), name));
        }
        places.push_back(static_cast<int>(found - parameters.list.begin()));
    }
    return places;
}

void read_identification(const fs::path& file, ModelUncertainty& uncertainty) {
    try {
        const json found = json::parse(mesh::read_text(file));
        const json& error = found.at("forecast_error");
        if (error.at("relative").is_number()) {
            uncertainty.forecast_error = {error.at("relative"), error.at("least_displacement_mm"), error.at("probes")};
        } else {  // of one or two probes what they left
            uncertainty.forecast_error = {found.at("model_error").is_number() ? found.at("model_error").get<double>()
                                                                              : 0.0};
        }
        const json& measured = found.at("measured");
        uncertainty.measured.force = measured.at("force_N");
        uncertainty.measured.displacement = measured.at("displacement_mm");
        for (const json& place : measured.at("places_mm"))
            uncertainty.measured.places.emplace_back(place.at(0).get<double>(), place.at(1).get<double>(),
                                                     place.at(2).get<double>());
    } catch (const json::exception& e) {
        throw InvalidInput(fmt::format("{}: is not what identify writes ({}); run it again", file.string(), e.what()));
    }
}

}  // namespace

std::optional<ModelUncertainty> read_uncertainty(const skeleton::Model& model, const fs::path& folder, int count) {
    const fs::path file = folder / "particles.csv";
    if (count == 0 || !fs::exists(file)) return std::nullopt;
    const ParticleSet particles = read_particles(file);
    if (particles.weights.size() == 0) return std::nullopt;
    const identify::Parameters parameters = identify::group_stiffness(model, scope_of(particles.parameters));
    const std::vector<int> places = places_of(particles.parameters, parameters, file);
    ModelUncertainty uncertainty;
    read_identification(folder / "identify.json", uncertainty);
    for (const int particle : identify::low_variance_resample(particles.weights.array().log(), count, 0.5)) {
        Eigen::VectorXd theta = Eigen::VectorXd::Zero(parameters.size());
        for (std::size_t p = 0; p < places.size(); ++p) {
            const double own = parameters.list[static_cast<std::size_t>(places[p])].stiffness;
            theta[places[p]] = std::log(particles.stiffness(particle, static_cast<Eigen::Index>(p)) / own);
        }
        uncertainty.draws.push_back(parameters.stiffness(theta));
    }
    return uncertainty;
}

}  // namespace palpate::pipeline
