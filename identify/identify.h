#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/motion/damping.h"
#include "mesh/progress.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Which links share a stiffness multiplier.
enum class Scope { uniform, zones, links };

enum class Method {
    tempered,    // particles from a Gaussian near the fit, tempered to the posterior; measured positions
    burion2008,  // Algorithm 1 as printed, in log weights; net forces and torques
};

/// What measurements are weighed by.
enum class Domain {
    by_method,  // tempered: position, burion2008: force
    position,   // the model's equilibria next to the measured markers
    force,      // the net forces that the model leaves in the measured configurations
};

/// Which law of equilibrium explains the measurements: told, or chosen by fit.
enum class LawChoice { automatic, linear, large_rotation };

struct IdentifyOptions {
    Scope scope = Scope::links;
    Method method = Method::tempered;
    Domain domain = Domain::by_method;
    LawChoice law = LawChoice::automatic;
    int particles = 0;        // 0: 200 (tempered), 600 (burion2008)
    int iterations = 20;      // burion2008: K
    double search_low = 0.1;  // burion2008: box V, as multiples of the model's own stiffness
    double search_high = 10.0;
    std::vector<skeleton::Stiffness> fixed;  // kinds that are known: they stay as the model has them
    std::uint64_t seed = 1;
    int threads = 1;
    void validate() const;  // @throws InvalidInput naming option, value, bound
};

/// A row of posterior.csv. A parameter that stands for several links tells their geometric mean stiffness.
struct PosteriorRow {
    std::string parameter;  // "elongation", "flexion:zone2", "torsion:link17"
    int link = -1;          // -1: stands for several
    std::string unit;
    double mean = 0, sd = 0, q025 = 0, q50 = 0, q975 = 0;
    double prior_mean = 0, prior_sd = 0;
    bool informed = false;  // sd <= 0.7 prior_sd
};

/// The particle set after a step of the filter.
struct FilterStep {
    double temperature = 0;  // tempered: 0 proposal .. 1 posterior; burion2008: iteration
    double effective_samples = 0;
    Eigen::MatrixXd particles;    // stiffnesses (particles x parameters), units as in the posterior
    Eigen::VectorXd log_weights;  // before resampling (particles), normalised
};

/// A maximum of the posterior.
struct Mode {
    double probability = 1;
    Eigen::VectorXd stiffness;  // there, of each parameter, units as in the posterior
};

/// Of the logarithms of two parameters' stiffness, in the posterior.
struct Correlation {
    int a = 0, b = 0;  // rows of the posterior, a < b
    double value = 0;
};

/// Range of the measurements, beyond which the model extrapolates.
struct MeasuredRange {
    double force = 0;          // the largest of one contact [N]
    double displacement = 0;   // the largest of a marker [mm]
    std::vector<Vec3> places;  // that were touched
};

/// How far a model is off under a probe that it was not fitted to, beyond the noise: so many mm rms are
/// `relative` times the root of u^2 + least_displacement^2, with u its rms displacement.
struct ForecastError {
    double relative = missing;      // rms over probes, each forecast from all others; NaN: not estimated
    double least_displacement = 0;  // [mm]
    int probes = 0;                 // that this was seen on
};

struct IdentifyResult {
    skeleton::Model model;                  // with the law and the most probable stiffness; burion2008: the mean
    std::vector<PosteriorRow> posterior;    // a row per parameter
    Eigen::VectorXd best;                   // the particle of highest weight (parameters)
    std::vector<Mode> modes;                // the most probable one first; none by burion2008
    std::vector<Correlation> correlations;  // of 0.7 and more, the strongest first, at most 100
    std::vector<FilterStep> history;
    std::vector<double> fit_trace;  // -ln density, but for a constant, at the start and after each step of the last fit
    double model_error = missing;   // of a prediction, beyond the noise, over its displacement; NaN: not estimated
    ForecastError forecast_error;
    MeasuredRange measured;
    std::optional<DampingResult> damping;  // for identify_damping to fill
    int states = 0, coordinates = 0;       // that were weighed
    double log_evidence = 0;
    double acceptance = 0;           // of the moves
    int equilibria = 0;              // solved
    std::vector<std::string> notes;  // what a user should know, in words
};

struct UniformFit;

/// Finds the stiffness of every link, so that the model follows the measurements. The model gets the most probable
/// stiffnesses together: marginal means of skewed, correlated distributions give a stiffer body that fits several times
/// worse. `near`: a uniform fit to other readings of the same model saves some time.
/// @throws InvalidInput when the set holds no loaded state with readings, or none of what the method needs.
IdentifyResult identify(const skeleton::Model& model, const MeasurementSet& set, const IdentifyOptions& options,
                        const Progress& progress = {}, const UniformFit* near = nullptr);

}  // namespace palpate::identify
