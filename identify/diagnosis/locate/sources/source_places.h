#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::identify {

/// A part of the body that a source may lie in: a Gaussian weight about a centre.
struct SourcePlace {
    Vec3 centre = Vec3::Zero();
    double radius = INFINITY;  // [mm]
    double extent = 0;         // rms distance of the weight from its centroid [mm]
    double norm = 1;           // sum of the weight by shares
    double log_prior = 0;      // of this place among all: radii are equally likely, and places of one radius
    Vec3 axis = Vec3::Zero();  // of fibres; into the body, of the skin there
    int number = -1;           // of a marker or probe
};

/// Places among points with shares, and their weights (points x places): several radii, and everywhere.
struct SourcePlaces {
    std::vector<SourcePlace> places;
    Eigen::MatrixXd weights;

    SourcePlaces(const Points& points, const Eigen::VectorXd& shares, double size);

    Eigen::Index count() const { return std::ssize(places); }
    /// Weights by shares that add up to 1 in each place.
    Eigen::MatrixXd unit(const Eigen::VectorXd& shares) const;
};

/// Forces of a unit along each axis, spread over points as the weights say: what readings feel, from what they feel of
/// forces on each point's coordinates (3n x r); columns are place by place, axis by axis (r x 3 places).
Eigen::MatrixXd spread(const Eigen::MatrixXd& of_points, const Eigen::MatrixXd& weights);

/// The same of forces of given directions, one at each point (n x 3).
Eigen::MatrixXd directed(const Eigen::MatrixXd& of_points, const Points& forces, const Eigen::MatrixXd& weights);

}  // namespace palpate::identify
