#include "identify/models/body_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "fem/effects/material/anisotropy.h"
#include "fem/effects/material/inclusion.h"
#include "fem/effects/material/prestress.h"
#include "fem/effects/material/stiffening.h"
#include "fem/effects/point/compliant_support.h"
#include "fem/effects/point/gravity.h"
#include "skeleton/model/state.h"
#include "tests/identify/small_body.h"

// Laws of every model of a body: the reference body and the skeleton, each under all its laws, with and without
// effects in force.

namespace palpate::identify {
namespace {

struct BodyCase {
    std::string name;
    bool is_skeleton;
    int law;
    bool effects;
};

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

TEST_P(BodyModelLaws, NetForcesVanishAtFreeDofsInEquilibrium) {
    const double load = model_->residual(model_->rest(setting_), setting_, action_).norm();
    // the solvers stop at 1e-7 and 1e-9 of the load; a skeleton's torques count over a length of 10 mm
    EXPECT_LT(only(free_, model_->residual(q_, setting_, action_)).norm(), 1e-6 * load);
    EXPECT_GT((model_->observe(q_, setting_) - model_->observe(model_->rest(setting_), setting_)).norm(), 5.0);
}

TEST_P(BodyModelLaws, ANeighbouringStartLeadsToTheSameEquilibrium) {
    const Eigen::VectorXd start = model_->advance(q_, 0.1 * random_steps(1, free_) * 0.3, setting_);
    const Eigen::VectorXd again = model_->equilibrium(setting_, action_, &start);
    // positions to 1e-7 of the load, through a compliance of some 100 mm/N
    EXPECT_LT((model_->observe(again, setting_) - model_->observe(q_, setting_)).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_P(BodyModelLaws, TangentIsMinusTheDerivativeOfTheResidual) {
    const auto residual = [&](const Eigen::VectorXd& q) { return model_->residual(q, setting_, action_); };
    const auto check = [&](const Eigen::MatrixXd& steps, const Eigen::ArrayX<bool>& rows) {
        const Eigen::MatrixXd J = model_->tangent_times(q_, setting_, action_, steps);
        for (Eigen::Index c = 0; c < steps.cols(); ++c) {
            const Eigen::VectorXd difference = along(residual, q_, steps.col(c));
            // central differences of step 1e-5 carry about eight digits; what the equilibrium leaves, six
            EXPECT_LT(only(rows, J.col(c) + difference).norm(), 1e-6 * only(rows, J.col(c)).norm()) << c;
        }
    };
    const Eigen::ArrayX<bool> all = Eigen::ArrayX<bool>::Constant(held_.size(), true);
    check(random_steps(4, free_), all);
    // What is held may be moved too; there the reaction's torque makes exponential coordinates matter.
    check(random_steps(4, all), free_);
}

TEST_P(BodyModelLaws, SolveInvertsTheTangent) {
    const auto tangent = model_->tangent(q_, setting_, action_);
    const Eigen::MatrixXd B = random_steps(5, Eigen::ArrayX<bool>::Constant(held_.size(), true));
    const Eigen::MatrixXd X = tangent->solve(B);
    EXPECT_EQ(only(!free_, X).norm(), 0);
    const Eigen::MatrixXd back = model_->tangent_times(q_, setting_, action_, X);
    // rounding times a condition number of some 1e5
    EXPECT_LT(only(free_, back - B).norm(), 1e-9 * B.norm());
}

TEST_P(BodyModelLaws, ParameterForceIsTheDerivativeOfTheResidual) {
    const Eigen::MatrixXd G = model_->parameter_force(q_, setting_, action_);
    ASSERT_EQ(G.cols(), std::ssize(model_->parameters()));
    for (Eigen::Index p = 0; p < G.cols(); ++p) {
        constexpr double h = 1e-5;
        ModelSetting ahead = setting_, behind = setting_;
        ahead.theta[p] += h;
        behind.theta[p] -= h;
        const Eigen::VectorXd difference =
            (model_->residual(q_, ahead, action_) - model_->residual(q_, behind, action_)) / (2 * h);
        EXPECT_LT((G.col(p) - difference).norm(), 1e-7 * difference.norm()) << p;  // h^2 and rounding over h
    }
}

TEST_P(BodyModelLaws, ObservationIsTheDerivativeOfWhatIsObserved) {
    const auto observe = [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
        const Points markers = model_->observe(q, setting_);
        return Eigen::Map<const Eigen::VectorXd>(markers.data(), markers.size());
    };
    const Eigen::MatrixXd steps = random_steps(4, Eigen::ArrayX<bool>::Constant(held_.size(), true));
    // Next to the equilibrium and in a large rotation.
    for (const Eigen::VectorXd& q : {q_, model_->advance(moved_as_one(), 0.1 * steps.col(0), setting_)}) {
        const Eigen::SparseMatrix<double> P = model_->observation(q, setting_);
        ASSERT_EQ(P.rows(), 3 * std::ssize(body_.markers));
        for (Eigen::Index c = 0; c < steps.cols(); ++c) {
            const Eigen::VectorXd difference = along(observe, q, steps.col(c));
            EXPECT_LT((P * steps.col(c) - difference).norm(), 1e-7 * difference.norm()) << c;  // rounding over h
        }
    }
}

TEST_P(BodyModelLaws, SkinMotionIsTheDerivativeOfWhereTheSkinStands) {
    const auto stand = [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
        const Points skin = model_->skin_positions(q, setting_);
        return Eigen::Map<const Eigen::VectorXd>(skin.data(), skin.size());
    };
    const Eigen::SparseMatrix<double> P = model_->skin_motion(q_, setting_);
    ASSERT_EQ(P.rows(), model_->skin().size());
    const Eigen::MatrixXd steps = random_steps(3, Eigen::ArrayX<bool>::Constant(held_.size(), true));
    for (Eigen::Index c = 0; c < steps.cols(); ++c) {
        const Eigen::VectorXd difference = along(stand, q_, steps.col(c));
        EXPECT_LT((P * steps.col(c) - difference).norm(), 1e-7 * difference.norm()) << c;  // rounding over h
    }
}

TEST_P(BodyModelLaws, TheSkinIsTheWholeSurfaceAndStandsAtRest) {
    EXPECT_NEAR(model_->skin_areas().sum(), 4 * 400 + 2 * 100, 1e-9);
    const Points at_rest = model_->skin_positions(model_->rest(setting_), setting_);
    EXPECT_LT((at_rest - model_->skin()).norm(), 1e-12);
}

TEST_P(BodyModelLaws, WhatDoesNotYieldRemembersNothing) {
    EXPECT_FALSE(model_->remember(q_, setting_, action_));
    EXPECT_FALSE(model_->has_cavities());
}

TEST_P(BodyModelLaws, ContactForceAddsUpToTheForce) {
    for (const mesh::Contact& contact : action_.contacts) {
        const Eigen::VectorXd f = model_->contact_force(q_, setting_, contact);
        Vec3 sum = Vec3::Zero();
        for (Eigen::Index row = 0; row < f.size(); row += per_place()) sum += f.segment<3>(row);
        EXPECT_LT((sum - contact.force).norm(), 1e-12 * contact.force.norm());  // rounding
    }
}

TEST_P(BodyModelLaws, ContactForceIsWhatAContactAddsToTheResidual) {
    Action without = action_;
    without.contacts.pop_back();
    const Eigen::VectorXd added = model_->residual(q_, setting_, action_) - model_->residual(q_, setting_, without);
    const Eigen::VectorXd f = model_->contact_force(q_, setting_, action_.contacts.back());
    EXPECT_LT((f - added).norm(), 1e-9 * f.norm());  // rounding of forces of some 1 N
}

TEST_P(BodyModelLaws, AllPiecesTogetherAreWhatStiffens) {
    const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(model_->pieces().rows(), 1);
    const Eigen::MatrixXd G = model_->parameter_force(q_, setting_, action_);
    Eigen::VectorXd stiffer = Eigen::VectorXd::Zero(model_->dofs());
    for (Eigen::Index p = 0; p < G.cols(); ++p) {
        if (model_->parameters()[p].stiffens) stiffer += G.col(p);
    }
    const Eigen::VectorXd all = model_->piece_force(q_, setting_, action_, ones);
    EXPECT_LT((all - stiffer).norm(), 1e-10 * stiffer.norm());  // rounding
    // and each is its own share of it
    Eigen::MatrixXd halves(ones.rows(), 2);
    for (Eigen::Index p = 0; p < ones.rows(); ++p) halves.row(p) = Eigen::RowVector2d::Unit(p % 2);
    EXPECT_LT((model_->piece_force(q_, setting_, action_, halves).rowwise().sum() - all).norm(), 1e-10 * all.norm());
}

TEST_P(BodyModelLaws, PiecesAtASupportLieThere) {
    const std::vector<char>& cut = model_->pieces_at_support();
    ASSERT_EQ(std::ssize(cut), model_->pieces().rows());
    // The support is the face x = 0: it cuts what begins there, and an element or a link is 8 or 10 mm long.
    for (std::size_t p = 0; p < cut.size(); ++p) {
        EXPECT_EQ(cut[p] != 0, model_->pieces()(static_cast<Eigen::Index>(p), 0) < 8) << p;
    }
}

TEST_P(BodyModelLaws, TheSupportBearsAllLoads) {
    if (!setting_.effects.empty()) return;  // else springs bear them
    const Vec3 centre(1, 2, 3);
    const Eigen::VectorXd pressed =
        model_->support_motion(centre).transpose() * model_->residual(q_, setting_, action_);
    Vec3 sum = Vec3::Zero();
    for (const mesh::Contact& contact : action_.contacts) sum += contact.force;
    sum += 4e-6 * action_.gravity;                                   // 4000 mm^3 of 1e-9 tonne
    EXPECT_LT((pressed.head<3>() - sum).norm(), 1e-6 * sum.norm());  // what the equilibrium leaves
}

TEST_P(BodyModelLaws, SupportMotionIsARigidMotionOfWhatIsHeld) {
    const Vec3 centre(4, -3, 2);
    Eigen::MatrixXd rigid = rigid_steps();
    rigid.rightCols(3) -= rigid.leftCols(3) * -skeleton::skew(centre);  // about the centre
    EXPECT_LT((model_->support_motion(centre) - only(held_, rigid)).norm(), 1e-12 * rigid.norm());
    EXPECT_GT(held_.count(), 5);
    EXPECT_NEAR(model_->support_shares().sum(), 1, 1e-12);
    EXPECT_LT(model_->support_points().col(0).cwiseAbs().maxCoeff(), 6);  // a sphere bears points on its own axes
}

TEST_P(BodyModelLaws, ARigidMotionOfBodyAndBaseCostsNothing) {
    setting_.effects = {};
    const Eigen::VectorXd rest = model_->rest(setting_);
    const Eigen::MatrixXd S = rigid_steps();
    const double stiff =
        model_->tangent_times(rest, setting_, {}, random_steps(1, !held_)).norm() / random_steps(1, !held_).norm();
    EXPECT_LT(model_->tangent_times(rest, setting_, {}, S).norm(), 1e-12 * stiff * S.norm());  // rounding
    if (!is_nonlinear()) return;
    const Eigen::VectorXd q = moved_as_one();
    EXPECT_LT(model_->residual(q, setting_, {}).norm(), 1e-11 * stiff * 40);  // of forces for 40 mm
}

TEST_P(BodyModelLaws, YoungFollowsTheParametersThatStiffen) {
    ModelSetting stiffer = setting_;
    for (std::size_t p = 0; p < model_->parameters().size(); ++p) {
        if (model_->parameters()[p].stiffens) stiffer.theta[static_cast<Eigen::Index>(p)] += std::log(2);
    }
    EXPECT_NEAR(model_->young(stiffer) / model_->young(setting_), 2, 1e-12);
    EXPECT_EQ(model_->size(), 40);
}

TEST_P(BodyModelLaws, NormalsPointOutwards) {
    EXPECT_LT((model_->normal_near(Vec3(20, 10, 5), 3) - Vec3::UnitY()).norm(), 1e-9);
    EXPECT_LT((model_->normal_near(Vec3(20, 5, 0), 3) + Vec3::UnitZ()).norm(), 1e-9);
}

TEST(PressureInACavity, ActsAsTheSameEffectDoesAndOnNothingAsAWhole) {
    const SmallBody body = SmallBody::hollow();
    const auto model = body.reference();
    ASSERT_TRUE(model->has_cavities());
    for (const int law : {0, 1, 2}) {
        ModelSetting known = bare_truth(*model, law).setting(), effect = known;
        effect.effects.pressure = 0.01;
        const Action under_pressure{.contacts = {}, .pressure = 0.01};
        const Eigen::VectorXd q = model->equilibrium(known, under_pressure, nullptr);
        EXPECT_GT(q.norm(), 0.01);
        const Eigen::VectorXd forces = model->residual(q, known, under_pressure) - model->residual(q, known, {});
        const Eigen::VectorXd by_effect = model->residual(q, effect, {}) - model->residual(q, known, {});
        EXPECT_LT((forces - by_effect).norm(), 1e-12 * forces.norm());
        EXPECT_LT(forces.reshaped(3, forces.size() / 3).rowwise().sum().norm(), 1e-10 * forces.norm());  // rounding
    }
}

std::vector<BodyCase> all_cases() {
    std::vector<BodyCase> cases;
    for (const bool effects : {false, true}) {
        const std::string suffix = effects ? "WithEffects" : "";
        cases.push_back({"ReferenceLinear" + suffix, false, 0, effects});
        cases.push_back({"ReferenceSvk" + suffix, false, 1, effects});
        cases.push_back({"ReferenceNeoHooke" + suffix, false, 2, effects});
        cases.push_back({"SkeletonLinear" + suffix, true, 0, effects});
        cases.push_back({"SkeletonLargeRotation" + suffix, true, 1, effects});
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(AllModels, BodyModelLaws, testing::ValuesIn(all_cases()),
                         [](const auto& about) { return about.param.name; });

TEST(ReferenceBody, AStripOfOneElementInThicknessBendsAsABeamWithThinElements) {
    const mesh::VolumeMesh strip = mesh::to_quadratic(mesh::make_bar({0, 0, 0}, {60, 6, 1.5}, {20, 2, 1}));
    const auto compliance = [&](double poisson, fem::Dilatation dilatation) {
        const ReferenceBody body(strip, {mesh::BoxRegion{{-1, -1, -1}, {1e-6, 7, 3}}},
                                 {{1, Vec3(60, 3, 1.5), std::nullopt}},
                                 {.young = 1000.0, .poisson = poisson, .dilatation = dilatation});
        Explanation bare;
        bare.theta.resize(std::ssize(body.parameters()));
        for (Eigen::Index p = 0; p < bare.theta.size(); ++p) bare.theta[p] = body.parameters()[p].start;
        const auto height = [&](double force) {
            const Action action{.contacts = {{Vec3(60, 3, 1.5), Vec3(0, 0, force), 0.5}}};
            return body.observe(body.equilibrium(bare.setting(), action), bare.setting())(0, 2);
        };
        return (height(0.01) - height(-0.01)) / 0.02;
    };
    const double beam = std::pow(60, 3) / (3 * 1000 * 6 * std::pow(1.5, 3) / 12);  // L^3 / 3 E I
    for (const double poisson : {0.0, 0.33}) {
        // the clamp holds the width, which a beam does not
        EXPECT_NEAR(compliance(poisson, fem::Dilatation::thin), beam, 0.03 * beam) << poisson;
    }
    EXPECT_GT(compliance(0.33, fem::Dilatation::mean), 1.08 * beam);
}

}  // namespace
}  // namespace palpate::identify
