#pragma once

#include <Eigen/Core>
#include <string>

#include "mesh/types.h"
#include "skeleton/effects/effect.h"

namespace palpate::identify {

/// The components of a unit vector: "(0.46, 0.00, -0.89)".
std::string components_in_words(const Vec3& unit);

/// A direction in words: "-z" where it lies within ten degrees of an axis, else "(0.46, -0.01, -0.89)".
std::string direction_in_words(const Vec3& direction);

/// A number of a record, `factor` times as large: "9.2 ± 0.5". @param covariance of the record's numbers (n x n);
/// empty: it is not known
std::string number_in_words(const skeleton::EffectRecord& record, std::size_t number, const Eigen::MatrixXd& covariance,
                            double factor = 1);

/// What is known of a fitted vector along one axis.
struct VectorComponent {
    double value, sd;
    double rest;      // length of the rest of the vector
    double least_sd;  // along the best-known axis
};

/// Do the readings leave it open? Where it may be 0 (within two standard deviations), so much of what is known
/// otherwise could be hidden along it (a quarter), and other axes are known far better (three times): a vector that is
/// known poorly, but equally well in all directions, keeps its direction.
bool is_undetermined(const VectorComponent& component);

/// A vector that was fitted, by size and direction: "9.2 ± 0.5 m/s² along -z; along x it is not determined (3 ± 4)".
/// Its part along an axis that the readings do not determine enters neither. @param unit the size of one `unit_name`
std::string vector_in_words(const Vec3& v, const Mat3& covariance, double unit, const std::string& unit_name,
                            const std::string& preposition = "along");

}  // namespace palpate::identify
