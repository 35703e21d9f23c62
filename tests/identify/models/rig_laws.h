#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/models/reference/reference_body.h"
#include "identify/models/rig.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "tests/identify/small_body.h"

namespace palpate::identify::rigs {

inline constexpr double none = NAN;  // a coordinate that is left free
inline constexpr int ball = 0, grip = 1, punch = 2, platen = 3;
inline constexpr int pull = 0, cable = 1, chamber = 2;

/// A bar with four tools, two tendons and a chamber.
inline Rig rig_of_bar() {
    const auto tendon = [](double y, double z, bool by_length) {
        Points path(4, 3);
        path << 0, y, z, 12, y, z - 1, 24, y, z + 0.5, 36, y, z;
        return mesh::TendonActuator{path, by_length};
    };
    const Vec3 end(40, 5, 5);
    return {
        {{.name = "ball", .shape = mesh::SphereShape{8}, .bonded = false, .origin = Vec3(25, 5, 18)},
         {.name = "grip",
          .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(39, -1, -1), Vec3(41, 11, 11)}}},
          .bonded = true,
          .origin = end},
         {.name = "punch", .shape = mesh::FlatShape{8, Vec3(0, 0, -1)}, .bonded = true, .origin = Vec3(20, 5, 10)},
         {.name = "platen", .shape = mesh::FlatShape{9, Vec3(0, 0, -1)}, .bonded = false, .origin = Vec3(22, 5, 10)}},
        {{.name = "pull", .kind = tendon(5, 8, false)},
         {.name = "cable", .kind = tendon(8, 5, true)},
         {.name = "chamber", .kind = mesh::PressureActuator{Vec3(20, 5, 5)}}}};
}

struct RigCase {
    std::string name;
    bool is_skeleton;
    int law;
    double friction = 0;  // of the tendons
};

struct NamedAction {
    std::string name;
    Action action;
};

/// The bar under each model and law.
class RigLaws : public testing::TestWithParam<RigCase> {
protected:
    RigLaws() {
        model_ = model(rig_of_bar());
        setting_.law = GetParam().law;
        setting_.effects.tendon_friction = GetParam().friction;
        setting_.theta.resize(std::ssize(model_->parameters()));
        for (Eigen::Index k = 0; k < setting_.theta.size(); ++k)
            setting_.theta[k] = model_->parameters()[k].start + 0.1;
    }

    std::unique_ptr<BodyModel> model(const Rig& rig) const {
        if (GetParam().is_skeleton)
            return std::make_unique<SkeletonBody>(body_.chain(), body_.markers, SmallBody::young, rig);
        return std::make_unique<ReferenceBody>(
            body_.mesh, body_.supports, body_.markers,
            ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true, .rig = rig});
    }

    static Action moved(const mesh::ToolMotion& motion, const std::vector<mesh::ActuatorSetting>& settings = {}) {
        Action action;
        action.motions = {motion};
        action.settings = settings;
        return action;
    }
    static std::vector<NamedAction> actions() {
        Action filled, back;
        filled.gravity = Vec3(0, 0, -2000);
        filled.settings = {{pull, 0.2}, {cable, 0.8}, {chamber, 0.01}};
        back.gravity = Vec3(0, 0, -2000);
        back.settings = {{pull, 0.1, {0.105}}, {cable, 0.6, {1}}};
        std::vector<NamedAction> all{
            {"grip", moved({grip, Vec3(-0.5, 1, -3), Vec3(0.05, 0.12, 0)})},
            {"grip that turns", moved({grip, Vec3(none, 1, -3), Vec3(none, none, none)})},
            {"punch and tendons", moved({punch, Vec3(0.2, 0.5, -1), Vec3(0, 0.03, 0)}, {{pull, 0.1}, {cable, 0.3}})},
            {"punch that shifts", moved({punch, Vec3(none, none, -1), Vec3(0, none, 0)})},
            {"chamber, weight and tendons", filled},
            // one sticks behind its turns, the other one slides back
            {"tendons on their way back", back}};
        // The linear law of a skeleton takes effects as they are at rest: nothing parts.
        if (!GetParam().is_skeleton || GetParam().law != 0)
            all.push_back({"ball", moved({ball, Vec3(0.2, 0.1, -1.5), Vec3::Zero()})});
        return all;
    }
    static std::vector<NamedAction> of(const std::vector<std::string>& names) {
        std::vector<NamedAction> some = actions();
        std::erase_if(some, [&](const NamedAction& one) { return std::ranges::find(names, one.name) == names.end(); });
        return some;
    }

    Eigen::ArrayX<bool> held() const { return model_->support_motion(Vec3::Zero()).rowwise().norm().array() > 0; }
    Eigen::VectorXd at_free(Eigen::VectorXd r) const {
        const Eigen::ArrayX<bool> fixed = held();
        for (Eigen::Index k = 0; k < r.size(); ++k)
            if (fixed[k]) r[k] = 0;
        return r;
    }
    Eigen::VectorXd random_step(unsigned seed) const {
        std::mt19937_64 engine(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        return at_free(Eigen::VectorXd::NullaryExpr(model_->dofs(), [&] { return uniform(engine); }));
    }
    /// d f(advance(q, s step)) / d s by central differences.
    template <class F>
    Eigen::VectorXd along(const F& f, const Eigen::VectorXd& q, const Eigen::VectorXd& step, double h) const {
        return (f(model_->advance(q, h * step, setting_)) - f(model_->advance(q, -h * step, setting_))) / (2 * h);
    }
    /// The largest force that holds the body in place.
    double force_at_support(const Eigen::VectorXd& q, const Action& action) const {
        const Eigen::VectorXd r = model_->residual(q, setting_, action);
        return (r - at_free(r)).norm();
    }

    SmallBody body_ = SmallBody::hollow();
    std::unique_ptr<BodyModel> model_;
    ModelSetting setting_;
};

}  // namespace palpate::identify::rigs
