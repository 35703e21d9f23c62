#pragma once

#include "skeleton/links/link_energy.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton::testing {

/// Where the two ends of a link are.
struct LinkEnds {
    Vec3 x_a = Vec3::Zero(), x_b = Vec3::Zero();
    Mat3 R_a = Mat3::Identity(), R_b = Mat3::Identity();

    void step(const Vec12& by) {
        x_a += by.segment<3>(0);
        R_a = rotation(by.segment<3>(3)) * R_a;
        x_b += by.segment<3>(6);
        R_b = rotation(by.segment<3>(9)) * R_b;
    }
    void move(const Mat3& R, const Vec3& shift) {
        x_a = R * x_a + shift;
        x_b = R * x_b + shift;
        R_a = R * R_a;
        R_b = R * R_b;
    }
    /// Both turned by up to 1 rad about each axis from a common, arbitrary rotation, and the second moved by up to 4 mm
    /// from where `arm`, from end to end at rest, would have it.
    void strain(const Vec3& arm, std::mt19937_64& engine) {
        const Mat3 common = rotation(random_vector(engine, 3));
        x_a = random_vector(engine, 30);
        x_b = x_a + common * arm + random_vector(engine, 4);
        R_a = rotation(random_vector(engine, 1)) * common;
        R_b = rotation(random_vector(engine, 1)) * common;
    }
};

}  // namespace palpate::skeleton::testing
