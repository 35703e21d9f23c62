#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "fem/effects/point/compliant_support.h"
#include "fem/effects/point/gravity.h"
#include "identify/models/body_model.h"
#include "skeleton/model/state.h"
#include "tests/identify/small_body.h"

namespace palpate::identify {

struct BodyCase {
    std::string name;
    bool is_skeleton;
    int law;
    bool effects;
};

/// A bar in equilibrium under contacts and its weight, by each model and law.
class BodyModelLaws : public testing::TestWithParam<BodyCase> {
protected:
    BodyModelLaws() {
        body_.markers = SmallBody::with_pins();
        if (GetParam().is_skeleton) {
            model_ = body_.skeleton();
        } else {
            model_ = body_.reference();
        }
        setting_ = bare_truth(*model_, GetParam().law).setting();
        setting_.theta.array() += 0.1;
        if (GetParam().effects) setting_.effects = effects(g_, ln_k_);
        action_.contacts = {SmallBody::probes()[1].contacts[0], SmallBody::probes(0.05)[3].contacts[0]};
        action_.gravity = Vec3(0, 1000, -2000);
        q_ = model_->equilibrium(setting_, action_);
        held_ = model_->support_motion(Vec3::Zero()).rowwise().norm().array() > 0;
        free_ =
            setting_.effects.empty() ? Eigen::ArrayX<bool>(!held_) : Eigen::ArrayX<bool>::Constant(held_.size(), true);
    }

    /// Of points, and in the material.
    static fem::Effects effects(const Vec3& g, double ln_k) {
        const Mat3 stress = Vec3(0.01, -0.005, 0.004).asDiagonal();  // far from what would make the bar buckle
        return {.points = {std::make_shared<fem::Gravity>(g), std::make_shared<fem::CompliantSupport>(std::exp(ln_k))},
                .material = {std::make_shared<fem::Stiffening>(0.5, 2),
                             std::make_shared<fem::Anisotropy>(std::vector<fem::Fibre>{{0.5, Vec3(1, 2, 0)}}),
                             std::make_shared<fem::Inclusion>(fem::Inclusion::sphere(Vec3(24, 6, 4), 8, 2)),
                             std::make_shared<fem::Prestress>(stress)}};
    }

    bool is_nonlinear() const { return model_->is_nonlinear(setting_); }
    int per_place() const { return GetParam().is_skeleton ? 6 : 3; }

    /// Rows of A where `rows` holds, the others zero.
    static Eigen::MatrixXd only(const Eigen::ArrayX<bool>& rows, const Eigen::MatrixXd& A) {
        return rows.cast<double>().matrix().asDiagonal() * A;
    }

    /// Steps whose lengths are like the configuration's (dofs x count), at the rows that are asked for.
    Eigen::MatrixXd random_steps(int count, const Eigen::ArrayX<bool>& rows) const {
        std::mt19937_64 engine(3);
        std::uniform_real_distribution<double> uniform(-1, 1);
        return only(rows, Eigen::MatrixXd::NullaryExpr(model_->dofs(), count, [&] { return uniform(engine); }));
    }

    /// d f(advance(q, s step)) / d s by central differences.
    template <class F>
    Eigen::VectorXd along(const F& f, const Eigen::VectorXd& q, const Eigen::VectorXd& step) const {
        constexpr double h = 1e-5;
        return (f(model_->advance(q, h * step, setting_)) - f(model_->advance(q, -h * step, setting_))) / (2 * h);
    }

    /// What a rigid motion about the origin does to all of the body at rest: translations, rotation vectors (dofs x 6).
    Eigen::MatrixXd rigid_steps() const {
        Eigen::MatrixXd S = Eigen::MatrixXd::Zero(model_->dofs(), 6);
        for (Eigen::Index i = 0; i < S.rows() / per_place(); ++i) {
            const Eigen::Index row = per_place() * i;
            S.block<3, 3>(row, 0).setIdentity();
            S.block<3, 3>(row, 3) = -skeleton::skew(place(i));
            if (per_place() == 6) S.block<3, 3>(row + 3, 3).setIdentity();
        }
        return S;
    }
    Vec3 place(Eigen::Index i) const {
        return GetParam().is_skeleton ? Vec3(10.0 * static_cast<double>(i), 5, 5) : Vec3(body_.mesh.nodes.row(i));
    }

    /// The whole body turned by 1.2 rad and moved.
    Eigen::VectorXd moved_as_one() const {
        const Vec3 w(0.6, -0.8, 0.6633), t(3, -2, 5);
        const Mat3 R = skeleton::rotation(w);
        Eigen::VectorXd step = Eigen::VectorXd::Zero(model_->dofs());
        for (Eigen::Index i = 0; i < step.size() / per_place(); ++i) {
            step.segment<3>(per_place() * i) = R * place(i) + t - place(i);
            if (per_place() == 6) step.segment<3>(per_place() * i + 3) = w;
        }
        return model_->advance(model_->rest(setting_), step, setting_);
    }

    const Vec3 g_{-500, 300, -2500};
    const double ln_k_ = std::log(0.4);
    SmallBody body_;
    std::unique_ptr<BodyModel> model_;
    ModelSetting setting_;
    Action action_;
    Eigen::VectorXd q_;
    Eigen::ArrayX<bool> held_, free_;
};

}  // namespace palpate::identify
