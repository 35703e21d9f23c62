#pragma once

namespace palpate::pipeline {

/// How a reference simulation probes a body.
struct ProbeOptions {
    static constexpr int most_probes = 10000, least_markers = 3, most_markers = 100000;
    static constexpr double most_share = 0.5;  // of the longest side

    int probes = 12;          // places that are touched, [1, most_probes]
    int held_out = 0;         // of them, how many are kept from the fit, spread evenly
    int markers = 150;        // surface points that are read, [least_markers, most_markers]
    double displacement = 0;  // largest, as a share of the longest side, [0, most_share]; 0: by how far the law reaches
    double radius = 0.06;     // of a contact patch, as a share of the longest side, (0, most_share]
    double noise = 0;         // 1 sigma added to every reading [mm]
    void validate() const;
    /// What is asked for, else 0.5 % in small strain and 5 % in large deformation.
    double largest_displacement(bool small_strain) const {
        return displacement > 0 ? displacement : small_strain ? 0.005 : 0.05;
    }
};

}  // namespace palpate::pipeline
