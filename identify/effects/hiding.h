#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/models/body_model.h"
#include "identify/particles/random.h"
#include "identify/set/measurement_set.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

/// What is in force behind measurements that are made up, beside what their probes are told to do, and how they are
/// read.
struct World {
    Setting setting;
    double gain = 1;            // every second probe (2, 4, ...) presses so many times as hard as it reports
    Vec3 shift = Vec3::Zero();  // of the readings' frame [mm]
    Vec3 turn = Vec3::Zero();   // of it about the centre of the markers at rest, a rotation vector [rad]
    double off_share = 0;       // of the readings, that are off by themselves
    double off_width = 0;       // by so many sigmas of the noise

    /// Marker positions as they are read: y = c + shift + R(turn) (x - c), c the centre of the markers at rest.
    Points see(const std::vector<Marker>& rest, const Points& markers) const;
    /// What readings that are off by themselves add to the mean square [mm^2]; `noise`: 1 sigma [mm].
    double scatter(double noise) const;
};

/// What has to be done for an effect to show in measurements that are made up.
struct HidingNeeds {
    bool release = false;       // one body goes through all probes, let go after each: it shows in what stays
    bool dwells = false;        // loads are read at several times after they were put on
    bool noise = false;         // its numbers are told in sigmas
    bool told_poisson = false;  // the set tells a Poisson's ratio, which it belies
};

/// A number of an effect that is told. @pre it is.
double number_of(const skeleton::Effect& told, const std::string& name);

/// An effect in the making: all its numbers are told or drawn, but for how strong it is.
struct Draft {
    std::function<skeleton::Effect(double strength)> at;  // stronger with rising strength
    double start = 1, most = 1e9;                         // of strength; within [0, most] it is sensible
    double slope = 1;                                     // about d ln change / d ln strength
    double growth = 8;                                    // most that a trial may be stronger than the one before
    bool is_told = false;                                 // its strength too: at() gives the same whatever is asked
    bool is_local = false;                                // it may be felt by some probes only
    bool acts_at_rest = false;                            // on the untouched body, in proportion to its strength
};

/// What drafts are made of: the body that an effect is hidden in, and what is done to it.
struct Drawing {
    const BodyModel& model;
    const Setting& setting;                                 // its law and stiffness
    const MeasurementSet& set;                              // all of it but its states
    double stiffness;                                       // about its Young's modulus [MPa]
    std::optional<double> poisson;                          // none: it is a skeleton
    const std::vector<double>& dwell;                       // times at which a load that is held is read [s]
    const std::vector<std::vector<Eigen::VectorXd>>& bare;  // configurations with nothing hidden, of each probe and of
                                                            // the untouched body
    RandomStream random;

    bool is_skeleton() const { return !poisson; }
    bool in_small_strain() const { return !model.is_nonlinear(setting); }
};

/// The numbers of an effect that were told, over those that are drawn.
class ToldNumbers {
public:
    ToldNumbers(std::string effect, std::vector<skeleton::EffectParameter> given,
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
    skeleton::Effect effect(const std::vector<std::pair<std::string, double>>& drawn) const;

private:
    std::string effect_;
    std::vector<skeleton::EffectParameter> given_;
    std::vector<skeleton::KnownParameter> known_;
};

/// Of unit length, all directions alike.
Vec3 random_direction(RandomStream& random);

}  // namespace palpate::identify
