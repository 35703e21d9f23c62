#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// How large the nuisances are taken to be, as measured on bodies of known physics from another solver.
struct NuisanceOptions {
    double shift = 0.25;    // of a contact along the surface, 1 sd as a share of its radius
    double radius = 0.25;   // of its radius itself
    double softness = 0.3;  // of ln stiffness within two radii of a contact
    /// Of ln stiffness in each sector of the elements along a support's border. Where a clamp ends, or the mesh of
    /// another program, is known to an element: uniform over one, which is 1/sqrt(12) of its length.
    double clamp = 0.29;
    int clamp_sectors = 30;        // with six a border that is ragged was taken for an inclusion
    double gain_at_support = 0.3;  // of ln force of a probe, or what a tool feels, that reaches a support
    /// Of a tool's largest motion: its play, and what machine and grip yield under its largest force. Strain by
    /// the travel of a crosshead is off by some per cent, which is what extensometers are for.
    double play = 0.02;
    double dent = 0.1;  // of the local indentation, unknown for each reading
    /// The same of what a wall presses in at a point of the skin: no mesh tells where between such points it is
    /// touched, uniform over their distance, as for a clamp.
    double wall_dent = 0.29;
    double ragged = 0.15;  // of what a marker at a support's border moves against it, unknown for each reading
    /// Of the mesh's error that was computed and taken off: halved edges leave a third of it where it falls with
    /// the square of the edge, and what another
    /// program computed on such a mesh has it, too.
    double discretisation = 0.5;
    double flow = 0.01;  // of the displacement of a body that yields, unknown for each reading
};

/// Nuisances of the experimental setup: sensitivity columns over sigma (N x c), prior precisions (c) and names.
struct Nuisances {
    Eigen::MatrixXd columns;
    Eigen::VectorXd precisions;
    Eigen::Index of_mesh = 0;        // how many of the last columns are the error of the mesh
    std::vector<std::string> names;  // "contact of radius 2 mm at (0, 0, 8) shifted", ...
};

/// For each place that is touched, whatever probes, loads and times, two shifts of the contact along the surface, its
/// radius and the softness of the body round it; for each tool its play and the compliance of what moves it; the
/// stiffness of sectors of pieces that a support's border cuts; a gain of its own for a contact next to a support.
/// Their signatures are taken at the played configurations.
Nuisances make_nuisances(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                         const ForwardSolution& forward, int threads, const NuisanceOptions& options = {});

/// Radius of a contact as the nuisances see it: a point is never sharper than a hundredth of the body [mm].
double effective_radius(const BodyModel& model, const mesh::Contact& contact);

}  // namespace palpate::identify
