#pragma once

#include <vector>

#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"
#include "identify/models/rig.h"

namespace palpate::identify {

/// A state of the set in its original order, measured or not: the load history of a history-dependent body.
struct Stage {
    int probe = 0;    // as in the set
    double time = 0;  // [s]
    Action action;
};

/// Does anything press at the body, or move or pull at it: a contact, a tool, an actuator?
bool is_loaded(const Action& action);

/// How large what acts is, by its kind; kinds do not add up.
struct LoadSizes {
    double force = 0;    // of contacts [N]
    double way = 0;      // of tools, as far as it is told [mm]
    double setting = 0;  // of actuators, without their signs, in the units of each
};
LoadSizes sizes_of(const Action& action);

/// Do the same loads act, at the same gravity and pressure?
bool is_same(const Action& a, const Action& b);

/// A set's readings as one long vector of numbers, and what acted behind them. N rows: the numbers that were
/// measured; K actions: those that differ. States without load share one action; others do within a probe, when
/// nothing else acts on the body (creep, repeats). For a body with a memory `stage_by_stage` tells all states apart.
///
/// What can be read in a state are channels of three numbers each: the positions of the m markers, then the force on
/// the body and the moment of each tool.
struct Problem {
    std::vector<Action> actions;          // (K)
    std::vector<int> probe;               // of each action, as in the set; -1: one without load, which probes share
    std::vector<Stage> stages;            // all states, in order
    bool continuous = false;              // one body goes through all stages; else each probe finds it as new
    bool by_stage = false;                // the actions are the stages
    int markers = 0;                      // of the set (m)
    std::shared_ptr<const Rig> rig;       // of the set, its tools (t) and actuators (a)
    Points rest;                          // of the channels (m + 2t x 3): where the markers rest [mm], 0 of the tools
    std::vector<int> state;               // of each row, in the set (N)
    std::vector<int> action;              // of each row (N)
    std::vector<int> since, since_state;  // what a row's displacement counts from; -1: it is no difference (N)
    std::vector<int> coordinate;          // 3 channel + axis, of each row (N)
    std::vector<int> reading;             // rows of one reading share a number (N)
    std::vector<int> set_reading;         // the same, as the whole set numbers its readings (N)
    std::vector<char> is_guessed;         // rows whose sigma was not specified (N)
    Eigen::VectorXd measured, sigma;      // [mm], [N], [N mm] (N); without the next
    Eigen::VectorXd discretisation;       // how far the model would be off by its mesh [mm] (N); empty: not known
    double declared_poisson = missing;

    Eigen::Index rows() const { return measured.size(); }
    int readings() const { return reading.empty() ? 0 : reading.back() + 1; }
    bool loaded(int k) const { return is_loaded(actions[k]); }
    int channel(Eigen::Index n) const { return coordinate[n] / 3; }
    /// Is it a coordinate of a marker? Else it is a component of a tool's force or moment.
    bool is_position(Eigen::Index n) const { return channel(n) < markers; }
    bool is_force(Eigen::Index n) const { return !is_position(n) && (channel(n) - markers) % 2 == 0; }
    Eigen::Index count_positions() const;
    Eigen::Index count_forces() const;  // of tools
    /// The stage before action k in the life of the body; -1: the body is new. @pre by_stage
    int before(int k) const;
    /// The same problem with an action for each stage: its rows are the same.
    Problem stage_by_stage() const;
    /// The action of another problem about the same body that is like action k: with the same loads, of the same probe
    /// rather than of another, and of the same time where both tell; -1: there is none.
    int action_in(const Problem& other, int k) const;

    bool is_difference(Eigen::Index n) const { return since[n] >= 0; }
    /// Where a row counts from: where its marker rests; 0 of a difference.
    double origin(Eigen::Index n) const { return is_difference(n) ? 0 : rest(channel(n), coordinate[n] % 3); }

    /// The rows (N) out of each action's channels (K of m + 2t x 3).
    Eigen::VectorXd pick(const std::vector<Points>& channels) const;
    /// The same of displacements from rest, as they were measured [mm], and of reactions.
    Eigen::VectorXd displacement() const;
    /// rms over the positions of some values of the rows (N) [mm]; 0 where there are none.
    double rms_mm(const Eigen::VectorXd& values) const;
    /// The same over the forces of tools [N]; NaN where there are none.
    double rms_n(const Eigen::VectorXd& values) const;
    /// rms of errors (N) over rms displacement; of the forces where no position moved; NaN where there are none either.
    double relative(const Eigen::VectorXd& error) const;
    /// Takes another discretisation error off what was measured.
    void correct_for(Eigen::VectorXd error);
    /// The problem with only those rows that `keep` (N flags) holds for.
    Problem with_rows(const std::vector<char>& keep) const;
    /// The problem without some of the actions (K flags), renumbered, and without their rows; as if nothing had acted.
    Problem without_actions(const std::vector<char>& drop) const;
    double rms_sigma() const { return rms_mm(sigma); }  // of the positions [mm]
};

/// Labelled readings of the set; `noise` [mm] stands for a sigma that the set does not tell.
/// @throws InvalidInput when there are none.
Problem make_problem(const MeasurementSet& set, double noise);

/// The same where noise that is not told is a hundredth of how far the markers move: to begin with, as
/// errors tell it better once something is fitted.
Problem make_problem(const MeasurementSet& set);
/// The set without some of the readings, numbered as make_problem numbers them (ascending).
MeasurementSet without_readings(const MeasurementSet& set, const std::vector<int>& readings);

}  // namespace palpate::identify
