#include "pipeline/results/forecast.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "identify/fit/parameters.h"
#include "identify/fit/solver_pool.h"
#include "identify/parallel.h"
#include "identify/particles/resampling.h"
#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "pipeline/results/particles_file.h"
#include "pipeline/results/series.h"
#include "skeleton/statics.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

constexpr double two_sided_95 = 1.96;  // sd of a Gaussian

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

void read_identification(const fs::path& file, Doubts& doubts) {
    try {
        const json found = json::parse(mesh::read_text(file));
        if (found.at("model_error").is_number()) doubts.model_error = found.at("model_error");
        const json& measured = found.at("measured");
        doubts.measured.force = measured.at("force_N");
        doubts.measured.displacement = measured.at("displacement_mm");
        for (const json& place : measured.at("places_mm"))
            doubts.measured.places.emplace_back(place.at(0).get<double>(), place.at(1).get<double>(),
                                                place.at(2).get<double>());
    } catch (const json::exception& e) {
        throw InvalidInput(fmt::format("{}: is not what identify writes ({}); run it again", file.string(), e.what()));
    }
}

/// Of what draws and the model's own error leave open of a displacement.
void tell_spread(const std::vector<Points>& drawn, double model_error, Forecast& forecast) {
    const Points& u = forecast.displacement;
    const double error =
        model_error * std::sqrt(u.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, u.size())));
    forecast.sd = Eigen::VectorXd::Constant(u.rows(), error * error);
    for (const Points& other : drawn)
        forecast.sd += (other - u).rowwise().squaredNorm() / (3 * static_cast<double>(drawn.size()));
    forecast.sd = forecast.sd.cwiseSqrt();

    Eigen::Index most = 0;
    u.rowwise().norm().maxCoeff(&most);
    Eigen::VectorXd there(drawn.size());
    for (std::size_t d = 0; d < drawn.size(); ++d) there[static_cast<Eigen::Index>(d)] = drawn[d].row(most).norm();
    const Eigen::VectorXd weights = Eigen::VectorXd::Constant(there.size(), 1.0 / static_cast<double>(there.size()));
    const auto away = [&](double quantile) {
        const double by_stiffness = identify::weighted_quantile(there, weights, quantile) - forecast.largest;
        return std::hypot(by_stiffness, two_sided_95 * error);
    };
    forecast.low = std::max(0.0, forecast.largest - away(0.025));
    forecast.high = forecast.largest + away(0.975);
}

std::string probes_in_words(std::vector<int> probes) {
    probes.erase(std::unique(probes.begin(), probes.end()), probes.end());
    constexpr std::size_t most = 8;
    const bool all = probes.size() <= most;
    if (!all) probes.resize(most);
    return fmt::format("{} {}{}", probes.size() == 1 ? "Probe" : "Probes", fmt::join(probes, ", "), all ? "" : ", ...");
}

}  // namespace

std::optional<Doubts> read_doubts(const skeleton::Model& model, const fs::path& folder, int count) {
    const fs::path file = folder / "particles.csv";
    if (count == 0 || !fs::exists(file)) return std::nullopt;
    const ParticleSet particles = read_particles(file);
    if (particles.weights.size() == 0) return std::nullopt;
    const identify::Parameters parameters = identify::group_stiffness(model, scope_of(particles.parameters));
    const std::vector<int> places = places_of(particles.parameters, parameters, file);
    Doubts doubts;
    read_identification(folder / "identify.json", doubts);
    for (const int particle : identify::low_variance_resample(particles.weights.array().log(), count, 0.5)) {
        Eigen::VectorXd theta = Eigen::VectorXd::Zero(parameters.size());
        for (std::size_t p = 0; p < places.size(); ++p) {
            const double own = parameters.list[static_cast<std::size_t>(places[p])].stiffness;
            theta[places[p]] = std::log(particles.stiffness(particle, static_cast<Eigen::Index>(p)) / own);
        }
        doubts.draws.push_back(parameters.stiffness(theta));
    }
    return doubts;
}

std::vector<Forecast> forecast(const skeleton::Model& model, const std::vector<skeleton::Load>& loads,
                               const std::optional<Doubts>& doubts, int threads) {
    std::vector<Forecast> forecasts(loads.size());
    identify::SolverPool solvers(model);
    const Eigen::VectorXd k = skeleton::stiffness_vector(model);
    identify::for_each_in_parallel(static_cast<int>(loads.size()), threads, [&](int i) {
        const identify::SolverPool::Loan solver(solvers);
        const skeleton::Load& load = loads[static_cast<std::size_t>(i)];
        Forecast& here = forecasts[static_cast<std::size_t>(i)];
        here.equilibrium = solver->solve(k, load);
        here.displacement = skin_displacement(model, here.equilibrium, load);
        here.largest = here.displacement.rows() > 0 ? here.displacement.rowwise().norm().maxCoeff() : 0;
        here.low = here.high = here.largest;
        if (!doubts || here.displacement.rows() == 0) return;
        std::vector<Points> drawn;
        for (const Eigen::VectorXd& draw : doubts->draws) {
            try {
                const skeleton::Equilibrium found = solver->solve(draw, load, {}, &here.equilibrium.state);
                drawn.push_back(skin_displacement(model, found, load));
            } catch (const SolverFailure&) {
            }
        }
        if (!drawn.empty()) tell_spread(drawn, doubts->model_error, here);
    });
    return forecasts;
}

std::vector<std::string> extrapolations(const identify::MeasuredRange& measured,
                                        const std::vector<identify::LoadState>& states,
                                        const std::vector<Forecast>& forecasts, double size) {
    constexpr double more = 1.2;  // times what was measured
    constexpr double far = 0.15;  // from the nearest place that was touched, of the size
    std::vector<int> strong, far_off, wide;
    for (std::size_t s = 0; s < states.size(); ++s) {
        for (const mesh::Contact& contact : states[s].contacts) {
            if (contact.force.isZero(0)) continue;
            if (contact.force.norm() > more * measured.force) strong.push_back(states[s].probe);
            const bool is_near = std::ranges::any_of(
                measured.places, [&](const Vec3& place) { return (place - contact.point).norm() <= far * size; });
            if (!is_near) far_off.push_back(states[s].probe);
        }
        if (forecasts[s].largest > more * measured.displacement) wide.push_back(states[s].probe);
    }
    std::vector<std::string> words;
    if (!strong.empty())
        words.push_back(fmt::format("{}: pressed harder than anything that was measured, {:.3g} N at most.",
                                    probes_in_words(strong), measured.force));
    if (!far_off.empty())
        words.push_back(fmt::format("{}: further than {:.3g} mm from any place that was touched in the measurements.",
                                    probes_in_words(far_off), far * size));
    if (!wide.empty())
        words.push_back(fmt::format("{}: moved further than any marker that was measured, {:.3g} mm at most.",
                                    probes_in_words(wide), measured.displacement));
    if (!words.empty()) words.emplace_back("There the model extrapolates, and the intervals may be too narrow.");
    return words;
}

}  // namespace palpate::pipeline
