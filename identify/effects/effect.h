#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/problem.h"
#include "identify/effects/hiding.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

struct Explanation;
struct ForwardSolution;

/// Force signatures that differ from action to action: columns of a wide matrix that most actions know nothing of.
struct Signatures {
    Eigen::Index width = 0;  // columns in all
    /// What it is in an action.
    struct InAction {
        Eigen::MatrixXd forces = {};     // (dofs x c) [N]
        Eigen::MatrixXd steps = {};      // that what is held makes besides (dofs x c), or empty
        Eigen::MatrixXd reactions = {};  // what tools feel of it at once, by their motions (6 motions x c), or empty
        std::vector<int> columns = {};   // of the wide matrix (c, or those that `combine` makes)
        /// Makes other steps (dofs x ...) out of J^-1 forces; absent: they are what counts.
        std::function<Eigen::MatrixXd(const Eigen::MatrixXd& steps)> combine = {};
    };
    std::function<InAction(int k, const Eigen::VectorXd& q)> in_action;
};

using skeleton::EffectKind;

/// What `palpate effects` lists.
struct EffectDescription {
    std::string name;
    EffectKind kind;
    std::string meaning;
    std::vector<std::string> parameters;     // "gx, gy, gz [mm/s^2]: ..."
    std::string reveals;                     // what shows it
    std::vector<std::string> confused_with;  // effects
    std::string separating_probe;            // what tells it from those, in words
    std::string next_probe;                  // its kind: load, orientation, pressure, dwell, unload, repeat, fiducials
    std::string why_unshown = {};            // why a set may not show it whatever the noise; empty: see `reveals`
};

/// A number of an effect as the fit sees it: of a size near 1 where its physics leaves the choice.
struct EffectNumber {
    std::string name, unit;  // as they are told
    double start = 0;        // neutral, or where a fit begins
    double prior_mean = 0, prior_sd = 1;
    bool logarithm = false;          // the fit's number is its logarithm
    double least = -INFINITY;        // of the fit's number
    bool weakly_identified = false;  // weakly identified near its start, where a step may overshoot
    bool prior_at_start = false;     // its prior is centred where the fit begins: a direction, which a scan has found
};

/// What is known of the length of the vector that an effect's numbers are, whatever its direction: a normal
/// distribution of it. [numbers of the fit]
struct MagnitudePrior {
    double mean = 0, sd = 0;
};

/// First-order change of the readings by a weak effect, per alternative: groups of columns over sigma, as many numbers
/// wide as `prior_sd` is long, each group an alternative (other places, other directions).
struct ScreenColumns {
    Eigen::MatrixXd columns;   // (N x alternatives p)
    Eigen::VectorXd prior_sd;  // (p)
    bool one_sided = false;    // numbers below 0 have no meaning
    Eigen::Index alternatives() const { return prior_sd.size() > 0 ? columns.cols() / prior_sd.size() : 0; }
};

/// What a number of the screen says in a unit of its own, where the screen asks for another one than the fit.
struct ScreenedNumber {
    std::string name, unit;  // without a name it is how much there is of something that has several numbers
    std::function<double(double screened)> value = {};
    bool at_most = false;  // the weaker the effect, the larger the number, as the stiffness of a soft support
};

/// How an effect is screened: what it asks in every action, what follows from the answers, and where a refit begins.
struct ScreenPlan {
    Signatures signatures;  // nothing: width 0
    std::function<ScreenColumns(const Eigen::MatrixXd& sensitivities)> columns;
    /// Start values out of the best alternative and what the screen expects of its numbers.
    std::function<Eigen::VectorXd(Eigen::Index alternative, const Eigen::VectorXd& screened)> start;
    /// Which alternatives are one place or direction, from which a refit does not come to another. None: all are one.
    std::function<int(Eigen::Index alternative)> place = {};
    /// Where a refit may begin instead, from the least of the effect to the most: for one that shows only beyond a
    /// threshold, where no slope tells of it.
    std::vector<Eigen::VectorXd> scan = {};
};

/// What a probe changes about the body besides its loads.
struct ProbeConditions {
    Mat3 turn = Mat3::Identity();  // of the room's directions in the body's frame
    bool vented = false;           // its cavities stand open
};

/// A physical effect, or a fault of a measurement, that a model may lack: a candidate of the diagnosis. One file each.
///
/// `values` are the fit's numbers, in the order of `numbers`.
class EffectHypothesis {
public:
    virtual ~EffectHypothesis() = default;
    virtual const EffectDescription& description() const = 0;
    const std::string& name() const { return description().name; }
    bool is_of_body() const { return description().kind == EffectKind::body; }

    /// Is it of a skeleton's links alone? No solid has it.
    virtual bool is_of_links() const { return false; }

    /// Its numbers in a problem. None: it cannot show there.
    virtual std::vector<EffectNumber> numbers(const BodyModel& model, const Problem& problem) const = 0;

    /// What its numbers may be long, together; none: nothing is known of it.
    virtual std::optional<MagnitudePrior> magnitude() const { return std::nullopt; }

    // How it is in force; what it does not override it leaves as it is.

    /// Puts it in force on the body; false: it does not act there.
    virtual bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const;
    /// Changes what acts.
    virtual Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const;
    /// Marker positions as they are read; an affine map of each.
    virtual Points see(const Problem& problem, const Points& markers, const Eigen::VectorXd& values) const;

    /// Its numbers under other conditions than those of the set.
    virtual Eigen::VectorXd under(const ProbeConditions& conditions, const Eigen::VectorXd& values) const;

    /// Does it matter what happened before? Then problems are told stage by stage.
    virtual bool has_memory() const { return false; }

    /// Is it so nonlinear that the score test is unreliable? Then a refit is tried regardless of its screen if nothing
    /// else explains the readings.
    virtual bool evades_screen() const { return false; }
    /// Does it change the readings as errors of the body's mesh may: in one place, at the supports, in some directions
    /// more, where the body is strained, or under one probe more than under another?
    virtual bool is_like_mesh_error() const { return false; }

    /// Is it so general that it is asked only where no other effect explains the readings, and what is left is of the
    /// body's stiffness?
    virtual bool is_last_resort() const { return false; }
    /// May a body have several of it, told apart by where they lie?
    virtual bool may_repeat() const { return false; }
    /// Are two of it, with these numbers, different ones? Else they may be one of a shape of its own. @pre may_repeat()
    virtual bool lie_apart(const Eigen::VectorXd& /*one*/, const Eigen::VectorXd& /*other*/) const { return true; }
    /// Does a number mean the same on another specimen? Amplitudes at places that only this body has do not.
    virtual bool is_comparable(const std::string& /*number*/) const { return true; }
    /// Is that number fitted? Others only tell what it is of, as where something lies.
    virtual bool is_fitted(Eigen::Index /*number*/) const { return true; }
    /// d ln stiffness of the body's pieces / d its numbers (pieces x numbers), where that is all that they alter: the
    /// forces of all then take one pass over the body. None: they are differences of two passes for each number.
    virtual std::optional<Eigen::MatrixXd> piece_slopes(const BodyModel& /*model*/,
                                                        const Eigen::VectorXd& /*values*/) const {
        return std::nullopt;
    }
    /// How many of its first `numbers` are.
    Eigen::Index count_fitted(Eigen::Index numbers) const {
        Eigen::Index count = 0;
        for (Eigen::Index j = 0; j < numbers; ++j) count += is_fitted(j) ? 1 : 0;
        return count;
    }

    /// Of the evidence that it brings, the share that its idealisation (even springs, a ball) may leave to another
    /// effect.
    virtual double idealisation_share() const { return 5e-4; }

    /// Is it of single readings, which are found and set aside one by one (diagnosis/statistics/outliers), not fitted?
    /// It has no numbers of the fit then.
    virtual bool sets_readings_aside() const { return false; }

    /// None: the signatures of all numbers at their start, which must be neutral, and the start itself as the beginning
    /// of a refit (screen_plan_by_numbers). Keeps references to the arguments.
    virtual std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                                  const Explanation& explanation, const ForwardSolution& forward) const;

    /// How strong it is by the first number of its screen; none: by its own numbers.
    virtual std::optional<ScreenedNumber> screened_number() const { return std::nullopt; }

    /// Why a fit with it is implausible, in words; empty: no objection.
    virtual std::string objection(const Problem& problem, const Eigen::VectorXd& values) const;

    /// As an effect record: names, values and units as in model files.
    virtual skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                          const Eigen::VectorXd& values) const;
    /// Fit parameters from an effect record; parameters that it lacks take their start values.
    virtual Eigen::VectorXd values(const std::vector<EffectNumber>& numbers,
                                   const skeleton::EffectRecord& record) const;
    /// A sentence on what it is here: "Gravity of 9.8 m/s^2 along (0, 0, -1) is missing."
    virtual std::string sentence(const skeleton::EffectRecord& record) const = 0;
    /// The same with how well its numbers are known. @param covariance of the record's numbers (n x n)
    virtual std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const;
    /// The measurements as they would be without this fault, for models that do not know of it.
    virtual MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const;

    // How it is hidden in measurements that are made up (palpate probe --hide).

    /// Puts it in force behind them, as it is told; by default its physics.
    virtual void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const;
    /// Does the body stand as it does without it, and only its readings differ?
    virtual bool is_of_readings() const { return false; }
    /// What has to be done for it to show.
    virtual SynthesisNeeds needs() const { return {}; }
    /// Why it does not show where a rig drives the body in place of forces, and what to do; empty: it does.
    /// `tool_places`: at how many a tool presses.
    virtual std::string why_not_driven(int /*tool_places*/) const { return {}; }
    /// Its numbers as they are told for that; by default those of its physics.
    virtual std::vector<skeleton::KnownParameter> numbers_to_hide() const;
    /// The stream of random numbers that its own are drawn from, part of what a seed means: 0 to 22 are taken. None:
    /// nothing is drawn; one number may be left out, which is then how strong it is.
    virtual std::optional<std::uint64_t> stream() const { return std::nullopt; }
    /// What is told is taken, the rest drawn. Several: other places for it, for where it can hardly be felt in the
    /// first one. @pre stream() @throws InvalidInput for an effect that cannot be on this body.
    virtual std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const;
};

}  // namespace palpate::identify
