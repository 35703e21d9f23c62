#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "identify/diagnosis/diagnose.h"
#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "small_body.h"

namespace palpate::identify {

inline constexpr int neo_hookean = 2;
inline constexpr double sigma = 0.02;  // [mm], next to displacements of some 1 mm

inline const Vec3 half_g(0.02, -0.1, -0.5);  // [9810 mm/s^2]

inline Eigen::VectorXd numbers(std::initializer_list<double> values) {
    return Eigen::Map<const Eigen::VectorXd>(values.begin(), std::ssize(values));
}

class Diagnosed : public testing::Test {
protected:
    Explanation truth(int law = neo_hookean) const { return bare_truth(*model_, law); }
    Explanation truth(const std::string& effect, const Eigen::VectorXd& values) const {
        return with(truth(), find_effect(effect), values);
    }
    MeasurementSet twin(const Explanation& hidden, double noise = sigma, std::uint64_t seed = 1) const {
        return make_twin(*model_, body_.set(SmallBody::probes()), hidden, noise, seed);
    }
    Diagnosis diagnose(const MeasurementSet& set, const DiagnoseOptions& options = {}) const {
        return identify::diagnose(*model_, set, options);
    }
    static const Candidate& candidate(const Diagnosis& diagnosis, const std::string& name) {
        return *std::ranges::find_if(diagnosis.ranking, [&](const Candidate& c) { return c.effect->name() == name; });
    }
    static double estimate(const Candidate& c, const std::string& name) {
        return std::ranges::find(c.estimate.effect.parameters, name, &skeleton::EffectParameter::name)->value;
    }
    SmallBody body_;
    std::unique_ptr<ReferenceBody> model_ = body_.reference();
};

}  // namespace palpate::identify
