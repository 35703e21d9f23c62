#pragma once

#include <span>

#include "skeleton/runtime/kernels/tables.h"

namespace palpate::runtime {

/// Moves free spheres for a time h, as no force acts: x += h p / m, and turns by the angular momentum L, which stays.
/// Turning is split into five turns about the principal axes, 1 2 3 2 1, each by 2 atan(h L_i / 2 I_i): each is exact
/// for an energy that is a function of L_i alone, so the motion is symplectic; L and p do not change, so momenta are
/// kept. `n` spheres, the last batch filled up. [Reich 1994; McLachlan 1993]
void drift(std::span<const Masses> masses, double h, double* momentum, double* pose);

/// The same after forces changed momenta over a time, of which drag leaves a share: p <- kept (p + time f), and L by
/// the torques; of held spheres too, which do not heed it.
void kick_and_drift(std::span<const Masses> masses, double time, double kept, const double* force, double h,
                    double* momentum, double* pose);

/// Velocities of momenta: v = p / m, w = R I^-1 R^T L; of held spheres 0. Returns the kinetic energy [N mm].
double velocities(std::span<const Masses> masses, const double* momentum, const double* pose, double* velocity);

}  // namespace palpate::runtime
