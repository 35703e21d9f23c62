#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/diagnose/problem.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

struct Explanation;
struct Played;

enum class EffectKind {
    body,         // the body has it: it goes into the model
    measurement,  // a fault of the measurement: it goes into how the readings are understood
};

/// What `palpate effects` tells.
struct EffectDescription {
    std::string name;
    EffectKind kind;
    std::string meaning;
    std::vector<std::string> parameters;     // "gx, gy, gz [mm/s^2]: ..."
    std::string reveals;                     // what shows it
    std::vector<std::string> confused_with;  // effects
    std::string separating_probe;            // what tells it from those, in words
    std::string next_probe;                  // its kind: load, orientation, pressure, dwell, unload, repeat, fiducials
};

/// A number of an effect as the fit sees it: of a size near 1 where its physics leaves the choice.
struct EffectNumber {
    std::string name, unit;  // as they are told
    double start = 0;        // neutral, or where a fit begins
    double prior_mean = 0, prior_sd = 1;
    bool logarithm = false;  // the fit's number is its logarithm
};

/// A physical effect, or a fault of a measurement, that a model may lack: a candidate of the diagnosis. One file each.
///
/// `values` are the fit's numbers, in the order of `numbers`.
class Effect {
public:
    virtual ~Effect() = default;
    virtual const EffectDescription& description() const = 0;
    const std::string& name() const { return description().name; }
    bool is_of_body() const { return description().kind == EffectKind::body; }

    /// Its numbers in a problem. None: it cannot show there.
    virtual std::vector<EffectNumber> numbers(const BodyModel& model, const Problem& problem) const = 0;

    // How it is in force; what it does not override it leaves as it is.

    virtual std::shared_ptr<const fem::PointPotential> potential(const Eigen::VectorXd& values) const;
    virtual Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const;
    /// Marker positions as they are read; an affine map of each.
    virtual Points see(const Problem& problem, const Points& markers, const Eigen::VectorXd& values) const;

    /// What its numbers add to the net force in an action (dofs x numbers); none by default.
    virtual Eigen::MatrixXd force(const BodyModel& model, const Problem& problem, const Setting& setting, int k,
                                  const Eigen::VectorXd& q, const Eigen::VectorXd& values) const;

    /// Is it neutral at the start values, so that the screen may take its signature there? If not, `screen_columns`
    /// gives one in its place.
    virtual bool neutral_at_start() const { return true; }
    /// Columns over sigma (N x p) with their prior standard deviations (p): what a weak effect does to a model that
    /// lacks it. @pre not neutral_at_start.
    struct ScreenColumns {
        Eigen::MatrixXd columns;
        Eigen::VectorXd prior_sd;
    };
    virtual ScreenColumns screen_columns(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                         const Played& played, int threads) const;
    /// Start values for a refit, out of what the screen expects of those columns.
    virtual Eigen::VectorXd start_after_screen(const ScreenColumns& columns, const Eigen::VectorXd& screened) const;

    /// Why a fit with it is no claim, in words; empty: nothing speaks against it. `enough_without`: what is left
    /// without it is noise already.
    virtual std::string objection(const Problem& problem, const Eigen::VectorXd& values, bool enough_without) const;

    /// For the model file: names, values and units as they are told.
    virtual skeleton::Effect told(const std::vector<EffectNumber>& numbers, const Eigen::VectorXd& values) const;
    /// The fit's numbers behind what was told; what was not told starts as a fit does.
    virtual Eigen::VectorXd values(const std::vector<EffectNumber>& numbers, const skeleton::Effect& told) const;
    /// A sentence on what it is here: "Gravity of 9.8 m/s^2 along (0, 0, -1) is missing."
    virtual std::string sentence(const skeleton::Effect& told) const = 0;
    /// The measurements as they would be without this fault, for models that do not know of it.
    virtual MeasurementSet corrected(const MeasurementSet& set, const skeleton::Effect& told) const;
};

}  // namespace palpate::identify
