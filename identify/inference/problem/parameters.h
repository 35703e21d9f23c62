#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "identify/inference/priors/markov_field.h"
#include "identify/inference/problem/identify_options.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// A number to identify: the logarithm of a multiplier that some stiffnesses of the model share.
struct Parameter {
    std::string name;  // "elongation", "flexion:zone2", "torsion:link17"
    skeleton::Stiffness kind = skeleton::Stiffness::elongation;
    int link = -1;            // the one that it belongs to; -1: several, or a sphere
    std::vector<int> owners;  // links, or spheres, whose stiffness of this kind it multiplies
    double stiffness = 0;     // geometric mean of theirs in the model [N/mm, N mm/rad or MPa]
};

/// k(theta) = k0 o exp(M theta), M (stiffnesses x P) with at most one 1 in a row. The model's stiffnesses stand as
/// skeleton::StiffnessOrder says.
struct Parameters {
    std::vector<Parameter> list;   // (P)
    Eigen::VectorXd k0;            // the model's own stiffnesses
    Eigen::VectorXi parameter_of;  // M: the parameter behind each stiffness, -1: stays as it is

    int size() const { return static_cast<int>(list.size()); }
    Eigen::VectorXd stiffness(const Eigen::VectorXd& theta) const;           // k
    Eigen::SparseMatrix<double> derivative(const Eigen::VectorXd& k) const;  // dk / dtheta
    Eigen::VectorXd units() const;                                           // what a multiplier of 1 stands for (P)
};

/// Which single links' multipliers are neighbours, of each kind: those of links that meet at a sphere, with weights
/// that add up to 1 at each of a link's ends, and volumes of spheres that a link joins, with as much in all.
/// @pre Scope::links.
std::vector<MarkovField::Edge> neighbours(const skeleton::Model& model, const Parameters& parameters);

/// The field over them that makes neighbours alike: correlated by 0.38 along a chain, with variance 1.
std::shared_ptr<const MarkovField> smoothness_field(const skeleton::Model& model, const Parameters& parameters);

/// The value of each kind of stiffness in a uniform fit, for the parameters of a finer scope.
Eigen::VectorXd spread_kinds(const Parameters& fine, const Parameters& uniform, const Eigen::VectorXd& theta);

/// Which stiffnesses share a multiplier: those of a kind, in all the model, in a zone, or of each link and sphere
/// alone; volumes have no zones. Flexion in a link's two planes is one kind here, and so is shear: their ratio is the
/// section's. Those of the kinds in `fixed`, and those that are zero, stay as they are.
/// @throws InvalidInput when nothing is left to identify.
Parameters group_stiffness(const skeleton::Model& model, Scope scope,
                           const std::vector<skeleton::Stiffness>& fixed = {});

}  // namespace palpate::identify
