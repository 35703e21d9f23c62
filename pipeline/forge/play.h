#pragma once

#include <limits>
#include <vector>

#include "identify/effects/hiding.h"
#include "pipeline/forge/course.h"
#include "pipeline/forge/specimen.h"
#include "skeleton/effects/effect.h"

namespace palpate::pipeline {

using identify::World;

/// The specimen with effects and faults of the measurement in force.
/// @throws InvalidInput for an effect that is not known, cannot be on this specimen, or has an impossible number.
World world_of(const Specimen& specimen, const std::vector<skeleton::Effect>& effects);

/// Does the body stand otherwise with this effect, or do only its readings differ?
bool moves_body(const skeleton::Effect& effect);

/// How a course went: a configuration a row. None: the body found no equilibrium in some row.
using Path = std::vector<Eigen::VectorXd>;

struct PlayOptions {
    bool continuous = false;  // one body goes through all courses, in order; else each finds it as new
    int threads = 1;          // changes no number
    bool is_patient = true;   // where no equilibrium is found next to `near` it is sought from rest, load by load; it
                              // takes long to learn that there is none
    int most_failures = std::numeric_limits<int>::max();  // courses without equilibrium, after which it is given up
};

/// Plays courses in a world. `near`: paths of the same courses in a similar world, where the search for equilibria
/// begins; empty ones do not matter. A body that remembers goes on from where it was before a course without
/// equilibrium.
std::vector<Path> play(const Specimen& specimen, const World& world, const std::vector<Course>& courses,
                       const PlayOptions& options, const std::vector<Path>* near = nullptr);

/// Where the markers are read, a row of the courses after the other; NaN where there is no path.
std::vector<Points> seen(const Specimen& specimen, const World& world, const std::vector<Course>& courses,
                         const std::vector<Path>& paths);

/// How far the markers and the skin stand apart in two configurations, at most [mm].
double largest_distance(const Specimen& specimen, const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace palpate::pipeline
