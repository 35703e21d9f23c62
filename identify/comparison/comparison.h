#pragma once

#include <optional>
#include <vector>

#include "identify/comparison/load_exponent.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

struct ProbeError {
    int probe = 0;
    double time = 0;
    double rms = 0, max = 0;  // [mm]
    double relative = 0;      // rms over rms displacement of this state; NaN for a state that does not move
};

struct WorstReading {
    int marker = 0, probe = 0;
    double time = 0;
    double error = 0;             // [mm]
    Vec3 at = Vec3::Zero();       // where the marker was measured [mm]
    Vec3 towards = Vec3::Zero();  // unit vector from model to measurement
};

/// The force of a tool on the body in a state [N].
struct ToolForce {
    int probe = 0;
    double time = 0;
    int tool = 0;                                       // index among the set's tools
    Vec3 measured = Vec3::Zero(), modelled = measured;  // measured: NaN where that axis is not
    double error() const { return measured.array().isNaN().select(0, measured - modelled).norm(); }
};

/// Forces of tools on the body, measured and modelled.
struct ReactionError {
    double rms = 0, max = 0;  // over all measured components [N]
    double relative = 0;      // rms over rms of what was measured; NaN where that is 0
    std::vector<ToolForce> forces = {};
};

/// A model against measurements. Of a set in which forces alone are read there are no positions: `relative` is that of
/// the forces then.
struct Comparison {
    double rms = 0;                             // over all measured coordinates [mm]; 0 where none was measured
    double max = 0;                             // of the error vectors' lengths [mm]
    double relative = 0;                        // rms over rms displacement
    double noise = missing;                     // rms of the readings' sigma [mm]; NaN when unknown
    bool adequate = false;                      // what is left is noise
    double p_value = missing;                   // of chi^2 of the errors over the noise; NaN when the noise is unknown
    std::optional<ReactionError> reactions;     // none: no force of a tool was measured
    std::optional<LoadExponent> load_exponent;  // none when the loads do not differ
    std::vector<ProbeError> probes;             // a row per state with readings
    std::vector<WorstReading> worst;            // the ten largest, largest first
    std::vector<int> overloaded_probes;  // probes without equilibrium under their full load: solved under a reduced one
    std::vector<Points> predicted;       // modelled marker positions of each state, in the order of its readings [mm]
};

}  // namespace palpate::identify
