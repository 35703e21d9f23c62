#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "identify/identify.h"
#include "skeleton/model.h"

namespace palpate::identify {

/// A number to identify: the logarithm of a multiplier that some stiffnesses of the model share.
struct Parameter {
    std::string name;  // "elongation", "flexion:zone2", "torsion:link17"
    skeleton::Stiffness kind = skeleton::Stiffness::elongation;
    int link = -1;           // the one that it belongs to; -1: several
    std::vector<int> links;  // whose stiffness of this kind it multiplies
    double stiffness = 0;    // geometric mean of theirs in the model [N/mm or N mm/rad]
};

/// k(theta) = k0 o exp(M theta), M (3L x P) with at most one 1 in a row.
struct Parameters {
    std::vector<Parameter> list;   // (P)
    Eigen::VectorXd k0;            // the model's own stiffnesses (3L), as skeleton::stiffness_vector orders them
    Eigen::VectorXi parameter_of;  // M: the parameter behind each stiffness (3L), -1: stays as it is

    int size() const { return static_cast<int>(list.size()); }
    Eigen::VectorXd stiffness(const Eigen::VectorXd& theta) const;           // k (3L)
    Eigen::SparseMatrix<double> derivative(const Eigen::VectorXd& k) const;  // dk / dtheta (3L x P)
    Eigen::VectorXd units() const;                                           // what a multiplier of 1 stands for (P)
};

/// Which stiffnesses share a multiplier; those of the kinds in `fixed`, and those that are zero, stay as they are.
/// @throws InvalidInput when nothing is left to identify.
Parameters group_stiffness(const skeleton::Model& model, Scope scope,
                           const std::vector<skeleton::Stiffness>& fixed = {});

}  // namespace palpate::identify
