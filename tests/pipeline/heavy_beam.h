#pragma once

#include <random>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/surface/read_surface.h"
#include "pipeline/body/reference_body.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {

/// Reads the beam's markers in each of its states anew, in a mesh finer than those that are fitted to it. `weight`:
/// gravity [mm/s^2]; noise as the set tells it, drawn from `seed`.
inline void read_beam(identify::MeasurementSet& set, const identify::ModelSetting& setting, const Vec3& weight,
                      unsigned seed) {
    const Reference truth = make_reference(set, 9);
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, *set.position_noise);
    for (identify::LoadState& state : set.states) {
        state.readings.clear();
        const Eigen::VectorXd u =
            truth.body->equilibrium(setting, {.contacts = state.contacts, .gravity = weight}, nullptr);
        const Points seen = truth.body->observe(u, setting);
        for (int m = 0; m < seen.rows(); ++m) {
            const Vec3 off(noise(engine), noise(engine), noise(engine));
            state.readings.push_back({m, seen.row(m).transpose() + off});
        }
    }
}

/// A cantilever of 1 MPa, 100 x 20 x 20 mm, pressed and pulled in five probes, whose own weight of 9.81 m/s^2 along -z
/// not specified: it sags by some 4 mm. Noise of 0.05 mm.
inline identify::MeasurementSet heavy_beam(bool heavy) {
    identify::MeasurementSet set;
    set.name = "heavy-beam";
    set.rest_surface = mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2});
    set.supports = {mesh::BoxRegion{{-1, -1, -1}, {1, 21, 21}}};
    set.density = 1e-9;
    set.position_noise = 0.05;
    for (const double x : {20.0, 35.0, 50.0, 65.0, 75.0, 85.0, 95.0, 100.0}) {
        for (const auto& [y, z] : {std::pair{0.0, 10.0}, {10.0, 20.0}, {20.0, 10.0}}) {
            set.markers.push_back({static_cast<int>(set.markers.size()), Vec3(x, y, z), std::nullopt});
        }
    }
    const auto load = [](double x, double y, double z, const Vec3& force) {
        return std::vector<mesh::Contact>{{{x, y, z}, force, 6}};
    };
    set.states = {{.probe = 0},
                  {.probe = 1, .contacts = load(95, 10, 20, {0, 0, -0.1})},
                  {.probe = 2, .contacts = load(95, 0, 10, {0, 0.1, 0})},
                  {.probe = 3, .contacts = load(60, 10, 20, {0, 0, 0.2})},
                  {.probe = 4, .contacts = load(60, 20, 10, {0, -0.2, 0.1})},
                  {.probe = 5, .contacts = load(80, 10, 0, {0, 0, 0.15})}};

    read_beam(set, {2, Eigen::Vector2d(std::log(1.0), std::log(0.1)), {}}, Vec3(0, 0, heavy ? -9810 : 0), 7);
    return set;
}

}  // namespace palpate::pipeline
