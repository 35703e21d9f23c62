#pragma once

#include <functional>
#include <vector>

#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// A reading in one action and state; a difference of two states is two entries of one row.
struct ReadingEntry {
    Eigen::Index row = 0;  // of the problem
    int action = 0;
    int state = 0;    // of the set
    double sign = 1;  // -1: what a difference counts from
};

/// All of them, those of an action side by side.
std::vector<ReadingEntry> reading_entries(const Problem& problem);

/// What the readings of an action feel of any forces G and any steps S of the configuration, over sigma:
///   (P J^-1 G + P S) / sigma,
/// by P J^-1 for each coordinate that is read there. J is symmetric: as many solves as coordinates, whatever the number
/// of forces, and however often a coordinate is read.
struct ActionAdjoint {
    int action = 0;
    Eigen::Index first = 0;                       // entry
    std::vector<Eigen::Index> columns = {};       // of each entry, below
    Eigen::VectorXd scale = {};                   // 1 / sigma of each entry
    Eigen::MatrixXd by_force = {}, by_step = {};  // J^-1 P^T and P^T (dofs x coordinates)

    Eigen::Index count() const { return scale.size(); }
    /// Of coordinates (coordinates x c), for each entry (count x c).
    Eigen::MatrixXd of_entries(const Eigen::MatrixXd& of_coordinates) const {
        return scale.asDiagonal() * of_coordinates(columns, Eigen::all);
    }
    Eigen::MatrixXd felt(const Eigen::MatrixXd& forces) const { return of_entries(by_force.transpose() * forces); }
};

/// Calls visit for each action that is read, in any order and from several threads.
void for_each_adjoint(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                      const ForwardSolution& forward, const std::vector<ReadingEntry>& entries, int threads,
                      const std::function<void(const ActionAdjoint&)>& visit);

}  // namespace palpate::identify
