#include "identify/live/filter.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "identify/diagnosis/rigged_skeleton.h"
#include "identify/inference/particles/proposal.h"
#include "identify/inference/posterior.h"
#include "identify/loading/load_history.h"
#include "identify/loading/read_state.h"
#include "identify/numerics/random.h"
#include "identify/numerics/spectrum_update.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr Eigen::Index most_directions = 192;  // of the statistic: a reading of an organ in some 50 ms
constexpr int most_of_a_reading = 32;          // directions that one reading tells about
constexpr double least_told = 1e-3;            // ratio of data to prior information, that is kept
constexpr std::size_t few_readings = 64;       // that are kept to be fitted anew
constexpr int most_steps = 4;                  // of Gauss and Newton, for one reading
constexpr double far = 0.25;                   // squared sd of a step, after which slopes are taken anew
constexpr double expected = 3, alarming = 15;  // of the cumulative sum of -ln p: what is taken off it, and its bound
constexpr double most_surprising = 12;         // -ln p of one reading: one alone is a slip, not a change
constexpr int stuck_after = 2;                 // the same position under another load
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

/// One reading seen from a mean v.
struct Filter::Linearisation {
    Eigen::VectorXd d;         // errors over sigma (3m)
    Eigen::VectorXd variance;  // of each, beside what is not known: the sigmas let a state's readings count once (3m)
    Eigen::MatrixXd W;         // orthonormal directions that it tells about (P x k)
    Eigen::MatrixXd B;         // J W = -B (3m x k)
    double squared_error = 0;  // of the markers [mm^2], over all coordinates
};

Filter::Filter(const skeleton::Model& model, MeasurementSet set, Calibration calibration, const FilterOptions& options)
    : model_(model),
      set_(std::move(set)),
      calibration_(std::move(calibration)),
      options_(options),
      attachments_(marker_attachments(model_, set_.markers)),
      loads_(std::make_unique<ContactLoads>(model_)),
      always_loaded_(is_always_loaded(model_)),
      kept_(calibration_.domain.states()),
      last_(set_.markers.size()) {
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
    state_.off.setZero(std::ssize(set_.markers));
    set_.states.clear();  // what follows is not kept
    keeps_all_ = kept_.size() <= few_readings && options_.forgetting == 1;
}

Eigen::VectorXd Filter::theta(const Eigen::VectorXd& v) const {
    return calibration_.prior.mean + calibration_.prior.coloured(v).col(0);
}

/// What is wrong with a reading, if it cannot be taken in; what can be mended is.
std::optional<std::string> Filter::fault_of(LoadState& reading, std::string& mended) {
    const StateName name{reading.probe, reading.time};
    if (state_.seen.contains(name)) return "was there already";
    const auto add = [&](const std::string& words) { mended += (mended.empty() ? "" : "; ") + words; };
    const auto later = state_.seen.upper_bound(name);
    if (later != state_.seen.end() && later->probe == name.probe) add("out of order");

    Vec3 load = Vec3::Zero();
    for (const mesh::Contact& contact : reading.contacts) {
        if (!contact.force.allFinite() || !contact.point.allFinite()) return "has a force that is no number";
        load += contact.force;
    }
    int infinite = 0, stuck = 0;
    for (Reading& own : reading.readings) {
        if (own.marker < 0 || own.marker >= static_cast<int>(last_.size())) continue;
        for (double& coordinate : own.position) {
            if (!std::isinf(coordinate)) continue;
            coordinate = missing;
            ++infinite;
        }
        Stuck& last = last_[own.marker];
        const bool same = own.position.allFinite() && own.position == last.position && load != last.load;
        last.times = same ? last.times + 1 : 0;
        last.position = own.position;
        last.load = load;
        if (last.times < stuck_after) continue;
        own.position.setConstant(missing);
        ++stuck;
    }
    if (infinite > 0) add(fmt::format("{} infinite coordinates count as missing", infinite));
    if (stuck > 0) add(fmt::format("{} markers are stuck where they were and are left out", stuck));
    return std::nullopt;
}

Filter::Linearisation Filter::linearise(const PositionDomain& domain, const Eigen::VectorXd& v) const {
    const LogNormalPrior& prior = calibration_.prior;
    const Eigen::VectorXd at = theta(v);
    const Prediction prediction = domain.predict(at, 1, nullptr, true);
    const ErrorJacobian jacobian = domain.jacobian(at, prediction, 1);
    const Spectrum told = leading_spectrum(whitened_curvature(jacobian, prior), domain.parameters().size(),
                                           {.largest = most_of_a_reading});
    const Eigen::Index k = (told.values.array() > least_told).count();
    Linearisation local;
    local.W = told.vectors.leftCols(k);
    const Eigen::VectorXd root = jacobian.weights(0).cwiseSqrt();
    local.B = root.asDiagonal() * jacobian.moved_markers(0, prior.coloured(local.W));
    local.d = root.cwiseProduct(jacobian.errors(0));
    local.squared_error = jacobian.errors(0).squaredNorm();
    const StateReadings& state = domain.states().front();
    const double of_model = Eigen::numext::abs2(calibration_.model_error) * domain.squared_scale(0);
    local.variance.setZero(local.d.size());
    for (Eigen::Index i = 0; i < local.d.size(); ++i) {
        const double noise = state.noise[i / 3];
        local.variance[i] = jacobian.weights(0)[i] * ((std::isnan(noise) ? 0 : Eigen::numext::abs2(noise)) + of_model);
    }
    return local;
}

double Filter::p_value(const Linearisation& local) const {
    // d^T (1 + B M B^T)^-1 d with M = W^T (1 + A)^-1 W, the covariance of what the reading tells about
    const Eigen::MatrixXd M = local.W.transpose() * state_.spectrum.inverse(1, local.W);
    const Eigen::VectorXd b = local.B.transpose() * local.d;
    const Eigen::MatrixXd G = local.B.transpose() * local.B;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(M.rows(), M.cols());
    const double explained = M.size() > 0 ? b.dot((one + M * G).partialPivLu().solve(M * b)) : 0;
    const double chi_squared = std::max(0.0, local.d.squaredNorm() - explained), count = local.variance.sum();
    return count > 0 ? boost::math::gamma_q(count / 2, chi_squared / 2) : 1;
}

void Filter::watch(const StateName& name, double p, const StateReadings& readings, const Linearisation& local) {
    const double surprise = std::min(most_surprising, -std::log(std::max(p, 1e-300)));
    state_.cusum = std::max(0.0, state_.cusum + surprise - expected);
    if (state_.cusum == 0) {
        state_.cusum_since.reset();
        state_.off.setZero();
        state_.off_count = 0;
        return;
    }
    if (!state_.cusum_since) state_.cusum_since = name;
    ++state_.off_count;
    for (std::size_t i = 0; i < readings.markers.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(3 * i);
        const double variance = local.variance.segment<3>(row).sum();
        if (variance > 0) {
            state_.off[readings.markers[i]] += 3 * local.d.segment<3>(row).squaredNorm() / variance;
        }
    }
}

std::optional<Alarm> Filter::alarm() const {
    if (state_.cusum < alarming || !state_.cusum_since) return std::nullopt;
    Alarm alarm{*state_.cusum_since};
    if (state_.off.size() == 0) return alarm;
    Eigen::Index worst = 0;
    const double most = state_.off.maxCoeff(&worst);
    alarm.marker = static_cast<int>(worst);
    alarm.at = set_.markers[alarm.marker].rest;
    alarm.whitened_rms = std::sqrt(most / (3.0 * std::max(1, state_.off_count)));
    return alarm;
}

FilterUpdate Filter::assimilate(const LoadState& given) {
    FilterUpdate update;
    LoadState reading = given;
    const StateName name{reading.probe, reading.time};
    const auto ends = [&](const std::string& why) {
        update.why = why;
        update.readings = state_.readings;
        update.alarm = alarm();
        return update;
    };
    if (const std::optional<std::string> fault = fault_of(reading, update.why)) return ends(*fault);
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
    std::optional<Linearisation> seen;
    try {
        seen = linearise(domain, state_.v);
    } catch (const SolverFailure& failure) {
        return ends(fmt::format("has no equilibrium by the model ({})", failure.what()));
    }
    update.p_value = p_value(*seen);
    update.error = std::sqrt(seen->squared_error / own.coordinates);
    watch(name, update.p_value, own, *seen);
    if (update.p_value < options_.surprise) {
        update.fate = FilterUpdate::Fate::held_back;
        return ends(update.why);
    }

    // Gauss and Newton on half of |d|^2 and (v - mean) (1 + A) (v - mean), slopes anew while it goes far
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
            seen = linearise(domain, v);
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
        row.q025 = median * std::exp(-1.959964 * sd);
        row.q50 = median;
        row.q975 = median * std::exp(1.959964 * sd);
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
    if (state.v.size() != state_.v.size() || state.off.size() != state_.off.size()) {
        throw InvalidInput(fmt::format(
            "the cloud is of {} numbers and {} markers, the model and the set have {} and {}: it belongs to another "
            "model, set or --parameters; remove the cloud to begin anew",
            state.v.size(), state.off.size(), state_.v.size(), state_.off.size()));
    }
    state_ = std::move(state);
    keeps_all_ = false;  // what it has taken in is no longer there to be fitted anew
    kept_.clear();
}

}  // namespace palpate::identify
