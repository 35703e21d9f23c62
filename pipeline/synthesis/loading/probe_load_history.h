#pragma once

#include <optional>
#include <vector>

#include "fem/effects/effects.h"
#include "identify/measurements/measurement_set.h"
#include "mesh/core/actuator.h"
#include "mesh/core/contact.h"
#include "mesh/core/tool.h"
#include "pipeline/synthesis/options.h"

namespace palpate::pipeline {

/// An instant at which the body is read.
struct Row {
    double time = 0;   // since the probe's beginning [s]
    double force = 0;  // of the probe [N]; 0: it lets go
};

/// What a probe moves or sets, in place of pressing with a force: `force` of its rows is how far or how much then.
struct RigDrive {
    int tool = -1;              // that is moved; -1: none
    Vec3 from = Vec3::Zero();   // its translation where it just touches [mm]
    Vec3 along = Vec3::Zero();  // unit direction that it is moved in from there, by so many mm
    int actuator = -1;          // that is set to so much; -1: none
    bool drives() const { return tool >= 0 || actuator >= 0; }
};

/// What one probe does: its contact, and row after row how hard it presses. The force of a row acts since the row
/// before it, that of the first since time 0.
struct ProbeLoadHistory {
    int probe = 0;
    mesh::Contact contact;  // with 1 N
    std::vector<Row> rows;
    RigDrive drive = {};  // in place of the contact, where it drives anything

    /// A tool's motion and an actuator's setting at an amount; none where it is 0: it is away, or off.
    std::vector<mesh::ToolMotion> motions(double amount) const;
    std::vector<mesh::ActuatorSetting> settings(double amount) const;
    /// The state of a measurement set that a row is.
    identify::LoadState state(std::size_t row) const;
    /// When the rows are read, up to one of them [s].
    std::vector<double> times_until(std::size_t row) const;
    /// The force that an elastic body would have to bear to stand as a creeping one does under what has acted so far
    /// (identify::superposition_weights).
    double effective_force(std::size_t row, const std::optional<fem::CreepLaw>& creep) const;
    /// The same a while before [s], if it changes evenly from row to row; 0 at time 0.
    double lagged_force(std::size_t row, double lag, const std::optional<fem::CreepLaw>& creep) const;
};

/// Probe 0: nothing touches the body.
ProbeLoadHistory unloaded_history();

/// Whether the body is let go after each load, whether it goes back through them, and how long after a load was put on
/// it is read.
struct LoadTiming {
    bool unload = false;
    bool back = false;          // after the last load those before it again, and nothing
    std::vector<double> dwell;  // [s]; empty: once, after a second
};

/// A probe's rows: each of its forces held as long as the last dwell time, and where it is let go, that as long as the
/// first one, which is when it is read.
std::vector<Row> rows_of(const std::vector<double>& forces, const LoadTiming& timing);

/// Shares of the largest displacement that a probe (from 0) presses to: `levels` even steps, or one of 1/3, 2/3 and 1
/// when that is 0, in turn. Push, pull and sideways come round every four probes: so each meets each level.
std::vector<double> levels_of(int probe, int levels);

}  // namespace palpate::pipeline
