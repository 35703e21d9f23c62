#include "identify/live/filter.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identify/diagnosis/rigged/rigged_skeleton.h"
#include "identify/inference/particles/proposal.h"
#include "identify/inference/posterior.h"
#include "identify/loading/history/load_history.h"
#include "identify/loading/readings.h"
#include "identify/numerics/random.h"
#include "identify/numerics/spectrum_update.h"
#include "identify/numerics/summaries.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr Eigen::Index most_directions = 192;  // of the statistic: a reading of an organ takes some 0.1 s
constexpr std::size_t few_readings = 64;       // that are kept to be fitted anew
constexpr int most_steps = 4;                  // of Gauss-Newton, for one reading
constexpr double far = 0.25;                   // squared sd of a step, after which slopes are taken anew
constexpr double informed_share = 0.7;         // of the prior's sd

}  // namespace

void FilterOptions::validate() const {
    const auto demand = [](bool holds, const char* option, double value, const char* allowed) {
        if (!holds) throw InvalidInput(fmt::format("option {} is {}; it must be {}", option, value, allowed));
    };
    demand(forgetting > 0 && forgetting <= 1, "forgetting", forgetting, "above 0 and at most 1 (nothing is forgotten)");
    demand(surprise > 0 && surprise <= 0.1, "surprise", surprise, "above 0 and at most 0.1");
    demand(particles >= 10, "particles", particles, "at least 10");
}

void require_followable(const skeleton::Model& model, const MeasurementSet& set) {
    constexpr const char* remedy = "identify the whole set, without --follow";
    const fem::Effects physics = skeleton::physics_of(model.effects);
    if (physics.creep || physics.remember()) {
        throw InvalidInput(
            fmt::format("the material of the model remembers its loads (viscosity, plasticity or damage), so that a "
                        "reading depends on all before it; readings are followed for elastic models alone: {}",
                        remedy));
    }
    if (is_rigged(set)) {
        throw InvalidInput(
            fmt::format("{}: the set moves tools, sets actuators or reads displacements since a state; "
                        "positions under contact forces are followed alone: {}",
                        set.name, remedy));
    }
}

Filter::Filter(const skeleton::Model& model, MeasurementSet set, Calibration calibration, const FilterOptions& options)
    : model_(model),
      set_(std::move(set)),
      calibration_(std::move(calibration)),
      options_(options),
      attachments_(marker_attachments(model_, set_.markers)),
      loads_(std::make_unique<ContactLoads>(model_)),
      always_loaded_(is_always_loaded(model_)),
      kept_(calibration_.domain.states()),
      faults_(set_.markers.size()) {
    options_.validate();
    require_followable(model_, set_);
    state_.v = calibration_.prior.whitened(calibration_.fit.theta);
    state_.spectrum = added(
        {}, calibration_.fit.spectrum.vectors * calibration_.fit.spectrum.values.cwiseMax(0).cwiseSqrt().asDiagonal(),
        most_directions, least_told);
    state_.readings = static_cast<int>(kept_.size());
    for (const StateReadings& known : kept_) {
        state_.seen.insert({set_.states[known.state].probe, set_.states[known.state].time});
    }
    state_.change.off.setZero(std::ssize(set_.markers));
    set_.states.clear();  // what follows is not kept
    keeps_all_ = kept_.size() <= few_readings && options_.forgetting == 1;
}

Eigen::VectorXd Filter::theta(const Eigen::VectorXd& v) const {
    return calibration_.prior.mean + calibration_.prior.coloured(v).col(0);
}

FilterUpdate Filter::assimilate(const LoadState& given) {
    FilterUpdate update;
    LoadState reading = given;
    const StateName name{reading.probe, reading.time};
    const auto ends = [&](const std::string& why) {
        update.why = why;
        update.readings = state_.readings;
        update.alarm = state_.change.alarm(set_.markers);
        return update;
    };
    if (const std::optional<std::string> fault = faults_.find(reading, state_.seen, update.why)) return ends(*fault);
    const StateReadings own = read_state(set_, reading, *loads_, attachments_, always_loaded_);
    if (own.rows.empty()) return ends("has no coordinate of a known marker");
    if (!own.informs_stiffness) return ends("nothing acts in it");
    state_.seen.insert(name);

    // Forgetting: the information of the readings before falls, and the mean goes towards the prior's.
    const auto information_times = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return x +
               state_.spectrum.vectors * state_.spectrum.values.cwiseProduct(state_.spectrum.vectors.transpose() * x);
    };
    if (options_.forgetting < 1) {
        const Eigen::VectorXd kept = options_.forgetting * information_times(state_.v);
        state_.spectrum.values *= options_.forgetting;
        state_.v = state_.spectrum.inverse(1, kept);
    }

    // The forecast, and its error.
    const PositionDomain domain = calibration_.domain.over({own}, calibration_.model_error);
    std::optional<LinearisedReading> seen;
    try {
        seen = linearise(domain, calibration_, state_.v);
    } catch (const SolverFailure& failure) {
        return ends(fmt::format("has no equilibrium by the model ({})", failure.what()));
    }
    update.p_value = p_value(*seen, state_.spectrum);
    update.error = std::sqrt(seen->squared_error / own.coordinates);
    state_.change.add(name, update.p_value, own, *seen);
    if (update.p_value < options_.surprise) {
        update.fate = FilterUpdate::Fate::held_back;
        return ends(update.why);
    }

    // Gauss-Newton on half of |d|^2 and (v - mean) (1 + A) (v - mean), slopes anew while it goes far
    const Eigen::VectorXd mean = state_.v;
    Eigen::VectorXd v = mean;
    Spectrum grown;
    for (int step = 1;; ++step) {
        const Eigen::MatrixXd root = (seen->B.transpose() * seen->B).llt().matrixL();
        grown = added(state_.spectrum, seen->W * root, most_directions, least_told);
        const Eigen::VectorXd downhill = seen->W * (seen->B.transpose() * seen->d) - information_times(v - mean);
        const Eigen::VectorXd dv = grown.inverse(1, downhill);
        const double length = downhill.dot(dv);
        v += dv;
        if (length < far || step == most_steps) break;
        try {
            seen = linearise(domain, calibration_, v);
        } catch (const SolverFailure&) {  // too far: half the way, by the slopes that are known
            v -= dv / 2;
            break;
        }
    }
    state_.v = v;
    state_.spectrum = std::move(grown);
    ++state_.readings;
    if (keeps_all_) kept_.push_back(own);
    keeps_all_ = keeps_all_ && kept_.size() <= few_readings;
    if (!keeps_all_) kept_.clear();
    refitted_ = false;

    update.fate = FilterUpdate::Fate::taken_in;
    update.informed = informed();
    return ends(update.why);
}

bool Filter::rejuvenate(int threads) {
    if (!keeps_all_ || refitted_ || kept_.empty()) return false;
    const PositionDomain domain = calibration_.domain.over(kept_, calibration_.model_error);
    FitOptions how{.tolerance = 1e-4};
    how.near = &state_.spectrum;
    const FitResult fit = fit_map(domain, calibration_.prior, theta(state_.v), threads, how);
    state_.v = calibration_.prior.whitened(fit.theta);
    state_.spectrum = added({}, fit.spectrum.vectors * fit.spectrum.values.cwiseMax(0).cwiseSqrt().asDiagonal(),
                            most_directions, least_told);
    refitted_ = true;
    return true;
}

std::vector<PosteriorRow> Filter::posterior() const {
    const Parameters& parameters = calibration_.domain.parameters();
    const LogNormalPrior& prior = calibration_.prior;
    const StiffnessPrior before = stiffness_prior(parameters, prior);
    const Eigen::VectorXd middle = theta(state_.v), units = parameters.units();
    // the prior's variance, less what the directions that are told of take off it
    const Eigen::MatrixXd CV = prior.coloured(state_.spectrum.vectors);
    const Eigen::VectorXd share = state_.spectrum.values.array() / (1 + state_.spectrum.values.array());
    const Eigen::ArrayXd variance = (prior.sd.array().square() - (CV.array().square().matrix() * share).array()).max(0);
    std::vector<PosteriorRow> rows;
    rows.reserve(static_cast<std::size_t>(parameters.size()));
    for (int p = 0; p < parameters.size(); ++p) {
        const Parameter& parameter = parameters.list[p];
        const double sd = std::sqrt(variance[p]), median = units[p] * std::exp(middle[p]);
        PosteriorRow row;
        row.parameter = parameter.name;
        row.link = parameter.link;
        row.unit = skeleton::stiffness_units[static_cast<int>(parameter.kind)];
        row.mean = median * std::exp(variance[p] / 2);
        row.sd = row.mean * std::sqrt(std::expm1(variance[p]));
        row.q025 = median * std::exp(-sds_of_95_percent * sd);
        row.q50 = median;
        row.q975 = median * std::exp(sds_of_95_percent * sd);
        row.prior_mean = before.mean[p];
        row.prior_sd = before.sd[p];
        row.informed = row.sd <= informed_share * row.prior_sd && sd <= informed_share * prior.sd[p];
        rows.push_back(std::move(row));
    }
    return rows;
}

int Filter::informed() const {
    const std::vector<PosteriorRow> rows = posterior();
    return static_cast<int>(std::ranges::count(rows, true, &PosteriorRow::informed));
}

Eigen::MatrixXd Filter::particles() const {
    const auto P = static_cast<int>(state_.v.size());
    const GaussianProposal q{theta(state_.v), calibration_.prior, state_.spectrum, 1};
    Eigen::MatrixXd z(P, options_.particles);
    for (int i = 0; i < options_.particles; ++i) {
        z.col(i) = RandomStream(options_.seed, static_cast<std::uint64_t>(state_.readings), i).normals(P);
    }
    return stiffness_of(calibration_.domain.parameters(), q.parameters(z).transpose());
}

skeleton::Model Filter::model() const {
    skeleton::Model result = calibrated(model_, calibration_);
    skeleton::set_stiffness(result, calibration_.domain.parameters().stiffness(theta(state_.v)));
    return result;
}

void Filter::resume(FilterState state) {
    if (state.v.size() != state_.v.size() || state.change.off.size() != state_.change.off.size()) {
        throw InvalidInput(fmt::format(
            "the cloud is of {} numbers and {} markers, the model and the set have {} and {}: it belongs to another "
            "model, set or --parameters; remove the cloud to begin anew",
            state.v.size(), state.change.off.size(), state_.v.size(), state_.change.off.size()));
    }
    state_ = std::move(state);
    keeps_all_ = false;  // what it has taken in is no longer there to be fitted anew
    kept_.clear();
}

}  // namespace palpate::identify
