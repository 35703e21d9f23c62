#pragma once

#include <array>
#include <string>
#include <vector>

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

}  // namespace palpate::identify
