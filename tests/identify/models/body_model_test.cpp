#include "identify/models/body_model.h"

#include <gtest/gtest.h>

#include "tests/identify/models/body_model_laws.h"

// Laws of every model of a body: the reference body and the skeleton, each under all its laws, with and without
// effects in force.

namespace palpate::identify {
namespace {

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

}  // namespace
}  // namespace palpate::identify
