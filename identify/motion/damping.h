#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/progress.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Posterior summary of a parameter.
struct PosteriorSummary {
    double mean = 0, sd = 0, q025 = 0, q50 = 0, q975 = 0;
    bool informed = false;  // sd <= 0.7 of the prior's
};

/// How damping goes with frequency, of a body that is damped as a model can be.
enum class DampingLaw {
    stiffness,  // the ratio grows with frequency: links resist the rates of their strains
    mass,       // the ratio falls with frequency: spheres resist their velocities
    both,       // [Rayleigh]
};
inline constexpr std::array<const char*, 3> damping_law_names{"stiffness", "mass", "both"};

/// A vibration that recordings show.
struct DampedMode {
    double frequency = 0;       // of the model [Hz]
    PosteriorSummary measured;  // frequency [Hz]
    PosteriorSummary ratio;     // its own damping ratio
    double played = 0;          // the ratio that the model plays it with
    double share = 0;           // of the motion's mean square that it makes
};

/// A marker's coordinate over time, of a recording: what a picture shows.
struct Trace {
    int probe = 0, marker = 0, axis = 0;         // marker: as in the files
    std::vector<double> time, measured, played;  // [s], [mm] from rest
};

struct DampingResult {
    DampingLaw law = DampingLaw::stiffness;
    bool law_is_identified = false;     // by the data; in doubt damping goes with stiffness
    skeleton::RayleighDamping damping;  // to be played, of the posterior's means
    PosteriorSummary ratio;             // of the slowest of the modes, by the law
    PosteriorSummary speed;             // of the body's vibrations over the model's, of all modes
    std::vector<double> log_evidence;   // of each law, less the largest; empty where one mode alone was seen
    std::vector<DampedMode> modes;      // the slowest first
    double rms = 0, displacement = 0;   // of what is left, and of the motion [mm]
    double mass = 1;                    // the model's masses were multiplied by that
    int readings = 0;                   // coordinates that were weighed
    double independent = 0;             // of them, as far as what is left is correlated
    double effective_samples = 0;       // of the particles
    std::vector<Trace> traces;          // of each recording, where it moves most
    std::vector<std::string> notes;     // what a user should know, in words
};

struct DampingOptions {
    int modes = 24;  // slowest ones that are looked at
    int most = 8;    // of them fitted
    int particles = 400;
    std::uint64_t seed = 1;
    int threads = 1;
};

/// Finds how a model's motion dies away from a set's recordings, and puts it into the model; nothing where the set has
/// none. Where the set tells no density and nothing weighs, masses are scaled so that the model vibrates as fast as
/// the body.
///
/// The markers ring in the model's modes about its equilibrium, q_i'' + 2 z_i w_i q_i' + w_i^2 q_i = 0 off the
/// equilibria between which loads change, so that every prediction is exact in time. Unknown are the ratio of the
/// slowest mode, how it goes with frequency (`law`, chosen by evidence), how much faster the body vibrates than the
/// model, when loads truly changed; and of each mode how far its own ratio, frequency and amplitude are off all that.
/// Errors of the model are alike from one instant to the next and from marker to marker: readings are weighed as so
/// many as are independent by the correlation of what the best fit leaves.
/// @throws InvalidInput when a sphere has no mass, or no mode moves the markers; SolverFailure as equilibrium.
std::optional<DampingResult> identify_damping(skeleton::Model& model, const MeasurementSet& set,
                                              const DampingOptions& options = {}, const Progress& progress = {});

}  // namespace palpate::identify
