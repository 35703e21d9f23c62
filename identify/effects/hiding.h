#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"
#include "identify/numerics/random.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

/// True conditions of a synthetic set: effects in force beyond the reported loads, and faults of its readings.
struct TrueConditions {
    ModelSetting setting;
    double gain = 1;            // every second probe (2, 4, ...) presses so many times as hard as it reports
    double share = 1;           // of the reported motion by which tools move
    double actuator_gain = 1;   // the first actuator does so many times what it is set to
    Vec3 shift = Vec3::Zero();  // of the readings' frame [mm]
    Vec3 turn = Vec3::Zero();   // of it about the centre of the markers at rest, a rotation vector [rad]
    double lag = 0;             // readings answer to loads of so long before [s]
    double outlier_share = 0;   // of the readings, that are off by themselves
    double outlier_width = 0;   // by so many sigmas of the noise

    /// Marker positions as they are read: y = c + shift + R(turn) (x - c), c the centre of the markers at rest.
    Points see(const std::vector<Marker>& rest, const Points& markers) const;
    /// What tools and actuators do where they are reported to do `action`.
    Action act(Action action) const;
    /// What readings that are off by themselves add to the mean square [mm^2]; `noise`: 1 sigma [mm].
    double scatter(double noise) const;
};

/// Requirements on the load histories of a synthetic set for an effect to be observable.
struct SynthesisNeeds {
    bool release = false;            // one body goes through all probes, let go after each: it shows in what stays
    bool reloads = false;            // one body goes through all probes, and each probe back to less than it bore
    bool changing_loads = false;     // a probe presses more and less hard, one state after the other
    bool dwells = false;             // loads are read at several times after they were put on
    bool noise = false;              // its numbers are given in sigmas
    bool specified_poisson = false;  // the set declares a Poisson's ratio, which it contradicts
};

/// A number of an effect that is told. @pre it is.
double number_of(const skeleton::EffectRecord& record, const std::string& name);

/// Sampler of an effect: all its parameters are specified or drawn, except its strength.
struct EffectSampler {
    std::function<skeleton::EffectRecord(double strength)> at;  // stronger with rising strength
    double start = 1, most = 1e9;                               // of strength; within [0, most] it is sensible
    double slope = 1;                                           // about d ln change / d ln strength
    double growth = 8;                                          // most that a trial may be stronger than the one before
    bool is_specified = false;  // its strength is specified too: at() ignores its argument
    bool is_local = false;      // only some probes may be sensitive to it
    bool acts_at_rest = false;  // on the untouched body, in proportion to its strength
};

/// Context of sampling: the body in which an effect is hidden, and its load histories.
struct SamplingContext {
    const BodyModel& model;
    const ModelSetting& setting;                                // its law and stiffness
    const MeasurementSet& set;                                  // all of it but its states
    double stiffness;                                           // about its Young's modulus [MPa]
    std::optional<double> poisson;                              // none: it is a skeleton
    const std::vector<double>& dwell;                           // times at which a load that is held is read [s]
    const std::vector<std::vector<Eigen::VectorXd>>& baseline;  // configurations with nothing hidden, of each probe and
                                                                // of the untouched body
    RandomStream random;

    bool is_skeleton() const { return !poisson; }
    bool in_small_strain() const { return !model.is_nonlinear(setting); }
};

/// Specified parameters of an effect; the others are drawn.
class SpecifiedNumbers {
public:
    SpecifiedNumbers(std::string effect, std::vector<skeleton::EffectParameter> given,
                     std::vector<skeleton::KnownParameter> known)
        : effect_(std::move(effect)), given_(std::move(given)), known_(std::move(known)) {}

    bool has(const std::string& name) const;
    bool has_any(const std::vector<std::string>& names) const;
    double value(const std::string& name, double drawn) const;
    /// The same, within (0, most]. @throws InvalidInput beyond.
    double positive_value(const std::string& name, double drawn, double most) const;
    /// Components of a vector: where one is told, those that are not are zero.
    Vec3 vector(const std::array<std::string, 3>& names, const Vec3& drawn) const;
    /// The effect with what is told, and what is drawn (rounded) for the rest, in the order in which its numbers are
    /// known; those that are neither are left out.
    skeleton::EffectRecord effect(const std::vector<std::pair<std::string, double>>& drawn) const;

private:
    std::string effect_;
    std::vector<skeleton::EffectParameter> given_;
    std::vector<skeleton::KnownParameter> known_;
};

/// Of unit length, all directions alike.
Vec3 random_direction(RandomStream& random);

}  // namespace palpate::identify
