#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "identify/diagnosis/ladder/ladder.h"
#include "identify/effects/catalogue.h"
#include "tests/identify/diagnosed.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {

/// A bar with something hidden in it, and its ladder with effects added.
class LadderTest : public testing::Test {
protected:
    LadderTest() {
        options_.identify.scope = Scope::uniform;
        options_.identify.particles = 50;
        options_.diagnose.law = neo_hookean;
    }

    MeasurementSet twin(const std::vector<std::pair<std::string, Eigen::VectorXd>>& hidden, int probes = 8) const {
        Explanation truth = bare_truth(*reference_, neo_hookean);
        for (const auto& [name, values] : hidden) truth = with(truth, find_effect(name), values);
        return make_twin(*reference_, body_.set(SmallBody::probes(0.03, probes)), truth, sigma);
    }
    Ladder build_ladder(const MeasurementSet& set, const std::vector<std::string>& effects) const {
        return identify::build_ladder(body_.chain(), *reference_, set, effects, options_);
    }
    static std::vector<std::string> names_of(const std::vector<skeleton::EffectRecord>& effects) {
        std::vector<std::string> names;
        for (const skeleton::EffectRecord& effect : effects) names.push_back(effect.name);
        return names;
    }

    const Eigen::VectorXd half_g_ = Vec3(0.02, -0.1, -0.5);
    const Eigen::VectorXd moved_ = (Eigen::VectorXd(6) << 0.3, -0.2, 0.1, 0.01, -0.015, 0.02).finished();
    SmallBody body_;
    std::unique_ptr<ReferenceBody> reference_ = body_.reference();
    LadderOptions options_;
};

}  // namespace palpate::identify
