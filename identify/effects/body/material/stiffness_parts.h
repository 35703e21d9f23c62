#pragma once

#include <vector>

#include "fem/effects/local/stiffness_map.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::identify {

// Of a record of a map, and of its fit: the length, then x, y, z and a of each place.
inline constexpr Eigen::Index numbers_of_map_place = 4;
constexpr bool is_amplitude_of_map(Eigen::Index number) { return number > 0 && number % numbers_of_map_place == 0; }

/// A part of the body that is stiffer, or softer, than the mean.
struct StiffnessPart {
    Vec3 centre = Vec3::Zero();  // of the places that it takes in, by how much each differs [mm]
    Vec3 peak = Vec3::Zero();    // where it differs most [mm]
    double ratio = 1, sd = 0;    // of its stiffness over the mean, there [-]
};

/// A map as it was fitted, and how well it is known.
class StiffnessEstimate {
public:
    /// @param covariance of the record's numbers (n x n); empty: it is not known
    /// @throws InvalidInput where the record is none of a map.
    explicit StiffnessEstimate(const fem::EffectRecord& record, const Eigen::MatrixXd& covariance = {});

    /// ln of the stiffness over its mean, and its standard deviation. The length of the kernels counts as known.
    double log_stiffness(const Vec3& X) const { return map_.log_stiffness(X); }
    double sd(const Vec3& X) const;

    /// Parts that differ by a quarter and by two standard deviations, the one that differs most first: places to one
    /// side of the mean, each within two lengths of another.
    std::vector<StiffnessPart> parts() const;
    double length() const { return map_.length(); }

    /// The part that each element of a body is of, by its place in parts(); -1: of none. A part reaches round its peak
    /// as far as ln stiffness differs by half as much or more.
    std::vector<int> part_of_elements(const mesh::VolumeMesh& body) const;

private:
    fem::StiffnessMap map_;
    Eigen::MatrixXd covariance_;  // of the amplitudes (n x n), or empty
};

}  // namespace palpate::identify
