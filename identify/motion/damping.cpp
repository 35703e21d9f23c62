#include "identify/motion/damping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/inference/particles/resampling.h"
#include "identify/inference/particles/tempered_filter.h"
#include "identify/motion/residuals.h"
#include "identify/motion/ringing_fit.h"
#include "identify/motion/vibration_speed.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

using Eigen::VectorXd;

double turns_a_second(double omega) { return omega / (2 * M_PI); }

/// What the modes make of the markers' motion without damping, as mean squares (n).
VectorXd amplitudes(const Ringdowns& ringdowns) {
    VectorXd squares = VectorXd::Zero(ringdowns.vibration.modes());
    for (const Ringdown& recording : ringdowns.recordings) {
        for (std::size_t s = 1; s < recording.stretches.size(); ++s) squares += recording.stretches[s].jump.cwiseAbs2();
    }
    return squares.cwiseProduct(ringdowns.shapes.colwise().squaredNorm().transpose());
}

/// Half the largest rate of instants over all recordings [Hz]: nothing faster is told apart. [Nyquist]
double fastest_resolved(const Ringdowns& ringdowns) {
    double fastest = 0;
    for (const Ringdown& recording : ringdowns.recordings) {
        const auto instants = recording.times.size();
        if (instants < 2) continue;
        const double lasted = recording.times[instants - 1] - recording.times[0];
        fastest = std::max(fastest, static_cast<double>(instants - 1) / lasted / 2);
    }
    return fastest;
}

/// The modes that move the markers most, in order of frequency.
std::vector<int> chosen_modes(const Ringdowns& ringdowns, int most) {
    constexpr double least = 0.01;  // of the mean square of the motion: what is less drowns in errors of the others
    const VectorXd share = amplitudes(ringdowns) / amplitudes(ringdowns).sum();
    const double fastest = fastest_resolved(ringdowns);
    std::vector<int> modes;
    for (int i = 0; i < share.size(); ++i) {
        if (share[i] >= least && turns_a_second(ringdowns.vibration.frequencies[i]) < fastest) modes.push_back(i);
    }
    if (modes.empty())
        throw InvalidInput(
            fmt::format("damping is not observable in the recordings: no excited mode lies below half the sampling "
                        "rate of {:g} per second. Sample faster, or excite a slower mode.",
                        2 * fastest));
    std::ranges::sort(modes, [&](int a, int b) { return share[a] > share[b]; });
    modes.resize(std::min(modes.size(), static_cast<std::size_t>(most)));
    std::ranges::sort(modes);
    return modes;
}

/// Of weighed positive values; informed by their logarithms, of which the prior's sd is told.
PosteriorSummary known(const VectorXd& values, const VectorXd& weights, double prior_sd) {
    PosteriorSummary summary;
    summary.mean = weights.dot(values);
    summary.sd = std::sqrt(weights.dot((values.array() - summary.mean).square().matrix()));
    summary.q025 = weighted_quantile(values, weights, 0.025);
    summary.q50 = weighted_quantile(values, weights, 0.5);
    summary.q975 = weighted_quantile(values, weights, 0.975);
    const VectorXd ln = values.array().log();
    const double middle = weights.dot(ln);
    summary.informed = std::sqrt(weights.dot((ln.array() - middle).square().matrix())) <= 0.7 * prior_sd;
    return summary;
}

/// A law's fit, and how it is weighed.
struct Fitted {
    DampingLaw law;
    RingdownFit fit;
    VectorXd theta;
    GaussianProposal proposal;
    double log_evidence = 0;
};

Fitted fitted(const Ringdowns& ringdowns, DampingLaw law, const VectorXd& start, double variance) {
    Fitted made{.law = law, .fit = RingdownFit(ringdowns, law), .theta = start, .proposal = {}};
    made.theta = made.fit.most_probable(start, variance);
    const LogNormalPrior& prior = made.fit.prior();
    const Eigen::MatrixXd J = made.fit.jacobian(made.theta) * prior.sd.asDiagonal() / std::sqrt(variance);
    const SymmetricProduct A = [&](const Eigen::MatrixXd& V) -> Eigen::MatrixXd { return J.transpose() * (J * V); };
    made.proposal = {.mean = made.theta,
                     .prior = prior,
                     .spectrum = leading_spectrum(A, static_cast<int>(prior.sd.size())),
                     .wider = 1 + 1.0 / static_cast<double>(prior.sd.size())};
    made.log_evidence = -made.fit.half_square(made.theta) / variance - prior.half_square(made.theta) -
                        (1 + made.proposal.spectrum.values.array()).log().sum() / 2;
    return made;
}

/// The start of a law's fit from that of the law `stiffness`: the same, and half of the ratio by mass.
VectorXd start_of(const VectorXd& stiffness, DampingLaw law) {
    if (law != DampingLaw::both) return stiffness;
    VectorXd start(stiffness.size() + 1);
    start << stiffness[0], 0, stiffness.tail(stiffness.size() - 1);
    return start;
}

constexpr double worth_a_law = 1;  // ln evidence that a law must have over those before it

class Identification {
public:
    Identification(const MeasurementSet& set, const DampingOptions& options, Ringdowns ringdowns)
        : set_(set), options_(options), ringdowns_(std::move(ringdowns)) {}

    DampingResult run() {
        const Fitted best = best_law();
        weigh(best);
        report_residual(best);
        report_traces(best);
        return std::move(result_);
    }

private:
    /// Noise that is told holds where the model is right; what is left tells where it is not.
    bool noise_is_known() const { return set_.position_noise.has_value(); }

    Fitted best_law() {
        const RingdownFit stiffness(ringdowns_, DampingLaw::stiffness);
        const VectorXd rest = stiffness.prior().mean;
        // at first all that moves is taken for error, so that no wrong number of cycles is preferred
        const double coarse = variance_of(residuals(stiffness, ringdowns_, rest), noise_is_known());
        VectorXd start = stiffness.most_probable(stiffness.scanned(coarse), coarse);
        for (int again = 0; again < 2; ++again) {
            variance_ = variance_of(residuals(stiffness, ringdowns_, start), noise_is_known());
            start = stiffness.most_probable(start, variance_);
        }
        std::vector<Fitted> fits;
        fits.push_back(fitted(ringdowns_, DampingLaw::stiffness, start, variance_));
        if (ringdowns_.vibration.modes() > 1) {
            for (const DampingLaw law : {DampingLaw::mass, DampingLaw::both})
                fits.push_back(fitted(ringdowns_, law, start_of(start, law), variance_));
        }
        const double most = std::ranges::max_element(fits, {}, &Fitted::log_evidence)->log_evidence;
        std::size_t best = 0;
        for (std::size_t i = 0; i < fits.size(); ++i) {
            if (fits.size() > 1) result_.log_evidence.push_back(fits[i].log_evidence - most);
            if (fits[i].log_evidence > fits[best].log_evidence + worth_a_law) best = i;
        }
        const auto rivals =
            std::ranges::count_if(fits, [&](const Fitted& one) { return one.log_evidence > most - worth_a_law; });
        result_.law_is_identified = fits.size() > 1 && rivals == 1;
        return std::move(fits[best]);
    }

    void weigh(const Fitted& best) {
        TemperedOptions how;
        how.particles = options_.particles;
        how.seed = options_.seed;
        how.threads = options_.threads;
        const LogDensity log_density = [&](const VectorXd& theta) {
            return -best.fit.half_square(theta) / variance_ + best.fit.prior().log_density(theta);
        };
        const TemperedResult filter = tempered_filter(log_density, {best.proposal}, how);
        const VectorXd weights = filter.log_weights.array().exp();
        result_.effective_samples = 1 / weights.squaredNorm();
        const auto each = [&](const auto& number) {
            VectorXd values(filter.particles.rows());
            for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = number(VectorXd(filter.particles.row(i)));
            return values;
        };
        const LogNormalPrior& prior = best.fit.prior();
        const int speed = best.law == DampingLaw::both ? 2 : 1;
        result_.law = best.law;
        result_.ratio =
            known(each([&](const VectorXd& theta) { return best.fit.common_ratio(theta); }), weights, prior.sd[0]);
        result_.speed =
            known(each([&](const VectorXd& theta) { return best.fit.speed(theta); }), weights, prior.sd[speed]);
        const double slowest = ringdowns_.vibration.frequencies[0] * result_.speed.q50,
                     share = best.fit.share_of_mass(best.theta);
        result_.damping = {.alpha = 2 * share * result_.ratio.q50 * slowest,
                           .beta = 2 * (1 - share) * result_.ratio.q50 / slowest};
        report_modes(best, each, weights);
    }

    void report_modes(const Fitted& best, const auto& each, const VectorXd& weights) {
        const VectorXd amplitude = amplitudes(ringdowns_);
        const VectorXd& sd = best.fit.prior().sd;
        for (int i = 0; i < ringdowns_.vibration.modes(); ++i) {
            const auto own = sd.size() - 3 * (ringdowns_.vibration.modes() - i);
            const auto frequency = [&](const VectorXd& theta) {
                return turns_a_second(best.fit.oscillator(theta, i, true).frequency);
            };
            const auto ratio = [&](const VectorXd& theta) { return best.fit.oscillator(theta, i, true).ratio; };
            result_.modes.push_back({.frequency = turns_a_second(ringdowns_.vibration.frequencies[i]),
                                     .measured = known(each(frequency), weights, sd[own + 1]),
                                     .ratio = known(each(ratio), weights, sd[own]),
                                     .played = best.fit.oscillator(best.theta, i, false).ratio,
                                     .share = amplitude[i] / amplitude.sum()});
        }
    }

    void report_residual(const Fitted& best) {
        const ResidualStatistics left = residuals(best.fit, ringdowns_, best.theta);
        result_.readings = left.readings;
        result_.independent = left.independent;
        double errors = 0, moved = 0;
        for (int r = 0; r < static_cast<int>(ringdowns_.recordings.size()); ++r) {
            const Ringdown& ringdown = ringdowns_.recordings[r];
            const Eigen::ArrayXXd unit_errors =
                best.fit.errors(best.theta, r).array() / ringdown.weights.array().max(1e-300);
            errors += unit_errors.square().sum();
            for (Eigen::Index t = 0; t < ringdown.times.size(); ++t) {
                const auto& rest = ringdown.stretches.back().rests;
                moved += (ringdown.weights.col(t).array() > 0)
                             .select((ringdown.measured.col(t) - rest).array().square(), 0.0)
                             .sum();
            }
        }
        result_.rms = std::sqrt(errors / left.readings);
        result_.displacement = std::sqrt(moved / left.readings);
    }

    /// Of each recording the coordinate that moves most.
    void report_traces(const Fitted& best) {
        for (int r = 0; r < static_cast<int>(ringdowns_.recordings.size()); ++r) {
            const Ringdown& ringdown = ringdowns_.recordings[r];
            const Eigen::MatrixXd played = best.fit.played(best.theta, r);
            Eigen::Index row = 0;
            (played.colwise() - played.rowwise().mean()).rowwise().squaredNorm().maxCoeff(&row);
            const Marker& marker = set_.markers[static_cast<std::size_t>(row / 3)];
            Trace trace{.probe = set_.recordings[r].probe,
                        .marker = marker.id,
                        .axis = static_cast<int>(row % 3),
                        .time = {},
                        .measured = {},
                        .played = {}};
            for (Eigen::Index t = 0; t < ringdown.times.size(); ++t) {
                if (ringdown.weights(row, t) == 0) continue;
                trace.time.push_back(ringdown.times[t]);
                trace.measured.push_back(ringdown.measured(row, t) - marker.rest[trace.axis]);
                trace.played.push_back(played(row, t) - marker.rest[trace.axis]);
            }
            result_.traces.push_back(std::move(trace));
        }
    }

    const MeasurementSet& set_;
    const DampingOptions& options_;
    Ringdowns ringdowns_;
    double variance_ = 1;
    DampingResult result_;
};

}  // namespace

std::optional<DampingResult> identify_damping(skeleton::Model& model, const MeasurementSet& set,
                                              const DampingOptions& options, const Progress& progress) {
    if (set.recordings.empty()) return std::nullopt;
    report(progress, "Vibrations", 0);
    const Ringdowns all = ringdowns(model, set, options.modes);
    report(progress, "Damping", 0.1);
    DampingResult result = Identification(set, options, of_modes(all, chosen_modes(all, options.most))).run();
    match_vibration_speed(model, set, result);
    model.damping = result.damping;
    return result;
}

}  // namespace palpate::identify
