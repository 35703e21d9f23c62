#include "skeleton/links/fibres/link_fibre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "skeleton/model/state.h"
#include "tests/skeleton/test_models.h"

namespace palpate::skeleton {
namespace {

const Vec3 rod_stiffness(2, 16, 20);  // of a link of a rod of 4 mm radius

TEST(FibreOffsets, HaveTheMomentsOfARoundSection) {
    Link link;
    link.stiffness = rod_stiffness;
    EXPECT_NEAR(radius_of_gyration(link), 2, 1e-15);  // of a circle of radius R = 4 mm: I / A = R^2 / 4
    for (const Vec3& n : {Vec3(1, 0, 0), Vec3(1, 2, -2), Vec3(-1, 1, 1)}) {
        const Vec3 direction = n.normalized(), across = direction.unitOrthogonal();
        const FibreOffsets offsets = fibre_offsets(link, direction);
        Vec3 first = Vec3::Zero();
        Mat3 second = Mat3::Zero();
        double area = 0;
        for (int j = 0; j < fibres_per_link; ++j) {
            area += fibre_weight;
            first += fibre_weight * offsets[j];
            second += fibre_weight * offsets[j] * offsets[j].transpose();
        }
        EXPECT_NEAR(area, 1, 1e-15);
        EXPECT_LT(first.norm(), 1e-15);
        EXPECT_LT((second - 4 * (Mat3::Identity() - direction * direction.transpose())).norm(), 1e-14);
        // The mean of y^4 over a circle is R^4 / 8, whichever way y goes.
        for (const double angle : {0.0, 0.4, 1.1}) {
            const Vec3 y = rotation(angle * direction) * across;
            double fourth = 0;
            for (int j = 0; j < fibres_per_link; ++j) fourth += fibre_weight * std::pow(y.dot(offsets[j]), 4);
            EXPECT_NEAR(fourth, 32, 1e-12);
        }
    }
}

TEST(FibreOffsets, BearAboutTheMomentOfARoundSectionThatYieldsThroughout) {
    Link link;
    link.gyration = 2;  // R = 4
    const FibreOffsets offsets = fibre_offsets(link, Vec3::UnitZ());
    for (double angle = 0; angle < 3.2; angle += 0.05) {
        double moment = 0;
        for (const Vec3& offset : offsets)
            moment += fibre_weight * std::abs(offset.x() * std::cos(angle) + offset.y() * std::sin(angle));
        EXPECT_NEAR(moment, 4 / (3 * std::numbers::pi) * 4, 0.03 * 4 / (3 * std::numbers::pi) * 4) << angle;
    }
}

TEST(FibreOffsets, KeepTheirSectionWhenTheStiffnessIsIdentified) {
    Model model = testing::make_chain(3, Vec3::UnitX(), rod_stiffness);
    Eigen::VectorXd k = stiffness_vector(model);
    k[1] *= 4;
    set_stiffness(model, k);
    EXPECT_NEAR(radius_of_gyration(model.links[0]), 2, 1e-15);
    Link slack;
    EXPECT_EQ(radius_of_gyration(slack), 0);
}

TEST(FibreShares, ResistTensionAndBendingAsTheLinkDoes) {
    // of the paper's link: a half of kF in each plane
    Link plain;
    plain.gyration = 2;
    plain.stiffness = Vec3(3, 20, 5);
    // a full one, three times as stiff in one plane as in the other
    Link full = plain;
    full.section = LinkSection{Vec3::Zero(), rotation({0.3, -0.2, 0.5}), 10};
    full.stiffness.resize(6);
    full.stiffness << 3, 18, 5, 6, 1, 1;
    for (const Link& link : {plain, full}) {
        const Vec3 direction = link.section ? Vec3(link.section->axes.row(0).transpose()) : Vec3(1, 0, 0);
        const FibreOffsets offsets = fibre_offsets(link, direction);
        const Eigen::VectorXd K = fibre_shares(link) * link.stiffness;
        EXPECT_NEAR(K.sum(), 3, 1e-14);
        Vec3 first = Vec3::Zero();
        Mat3 second = Mat3::Zero();
        for (int j = 0; j < fibres_per_link; ++j) {
            EXPECT_GT(K[j], 0);
            first += K[j] * offsets[j];
            second += K[j] * offsets[j] * offsets[j].transpose();
        }
        EXPECT_LT(first.norm(), 1e-14);
        Mat3 expected = 10 * (Mat3::Identity() - direction * direction.transpose());
        if (link.section) {
            const Mat3& f = link.section->axes;
            expected = 18 * f.row(1).transpose() * f.row(1) + 6 * f.row(2).transpose() * f.row(2);
        }
        EXPECT_LT((second - expected).norm(), 1e-13);
    }
    // where k is that of the section, all the same
    Link own;
    own.stiffness = rod_stiffness;
    const Eigen::VectorXd K = fibre_shares(own) * own.stiffness;
    for (int j = 0; j < fibres_per_link; ++j) EXPECT_NEAR(K[j], fibre_weight * rod_stiffness[0], 1e-13);
}

TEST(FibreShares, AreAllOnTheAxisWithoutASection) {
    Link slack;
    slack.stiffness = Vec3(2, 0, 0);
    const Eigen::VectorXd K = fibre_shares(slack) * slack.stiffness;
    EXPECT_NEAR(K.sum(), 2, 1e-15);
    for (const Vec3& offset : fibre_offsets(slack, Vec3::UnitX())) EXPECT_EQ(offset, Vec3::Zero());
}

}  // namespace
}  // namespace palpate::skeleton
