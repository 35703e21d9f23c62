// Which point is which, and tracks that a camera has mixed up.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "identify/numerics/random.h"
#include "identify/recordings/assembly/tracks/assignment.h"
#include "identify/recordings/assembly/tracks/mend_tracks.h"
#include "identify/recordings/assembly/tracks/name_points.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

TEST(Assignments, HaveTheLeastSumOfAll) {
    RandomStream random(1, 2, 3);
    for (int trial = 0; trial < 20; ++trial) {
        Eigen::MatrixXd cost(4, 5);
        for (double& c : cost.reshaped()) c = random.uniform();
        const std::vector<int> given = least_assignment(cost);
        double sum = 0, least = 1e9;
        for (int i = 0; i < 4; ++i) sum += cost(i, given[i]);
        std::vector<int> order{0, 1, 2, 3, 4};
        do {
            double other = 0;
            for (int i = 0; i < 4; ++i) other += cost(i, order[i]);
            least = std::min(least, other);
        } while (std::next_permutation(order.begin(), order.end()));
        EXPECT_DOUBLE_EQ(sum, least);
    }
}

Points five_places() {
    Points places(5, 3);
    places << 30, 0, -13, 25, 0, -129, -21, 0, -219, 20, 0, -280, 0, 0, -368;
    return places;
}

TEST(Names, OfABentBodysPointsAreFoundByTheirDistances) {
    const Points rest = five_places();
    // bent to a quarter of a circle, turned, moved, in another order
    Points bent(5, 3);
    for (int i = 0; i < 5; ++i) {
        const double s = rest(i, 2) / 240, r = 240 + rest(i, 0);
        bent.row(i) << r * std::cos(s), rest(i, 1), r * std::sin(s);
    }
    const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const std::vector<int> order{3, 0, 4, 1, 2};
    Points seen(5, 3);
    for (int i = 0; i < 5; ++i) seen.row(order[i]) = bent.row(i) * R.transpose() + Eigen::RowVector3d(7, 8, 9);
    const PointNames names = name_points(seen, rest);
    EXPECT_TRUE(names.is_clear);
    EXPECT_EQ(names.seen_of, order);
}

TEST(Names, OfSymmetricPointsAreNotClear) {
    Points square(4, 3);
    square << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    EXPECT_FALSE(name_points(square, square).is_clear);
}

TEST(Names, OfPointsOfWhichOneIsHiddenAreFound) {
    const Points rest = five_places();
    Points seen = rest.topRows(4);
    const PointNames names = name_points(seen, rest);
    EXPECT_EQ(names.seen_of, (std::vector<int>{0, 1, 2, 3, -1}));
}

/// Four points 20 mm apart that sway by a mm, 200 frames.
std::vector<RecordedPoint> swaying() {
    std::vector<RecordedPoint> points(4);
    for (int p = 0; p < 4; ++p) {
        points[p].name = std::to_string(p + 1);
        points[p].at.resize(3, 200);
        for (int f = 0; f < 200; ++f)
            points[p].at.col(f) << 20 * p + std::sin(0.05 * f), 5 * (p % 2), 0.1 * std::cos(0.3 * f + p);
    }
    return points;
}

double apart(const std::vector<RecordedPoint>& a, const std::vector<RecordedPoint>& b) {
    double most = 0;
    for (std::size_t p = 0; p < a.size(); ++p)
        for (Eigen::Index f = 0; f < a[p].at.cols(); ++f)
            if (a[p].at.col(f).allFinite()) most = std::max(most, (a[p].at.col(f) - b[p].at.col(f)).norm());
    return most;
}

TEST(Tracks, ThatWereExchangedAreExchangedBack) {
    const std::vector<RecordedPoint> truth = swaying();
    std::vector<RecordedPoint> points = truth;
    points[1].at.rightCols(120) = truth[2].at.rightCols(120);
    points[2].at.rightCols(120) = truth[1].at.rightCols(120);
    const TrackRepair repair = mend_tracks(points);
    EXPECT_EQ(repair.swaps, 1);
    EXPECT_EQ(repair.flickers, 0);
    EXPECT_EQ(apart(points, truth), 0);
    EXPECT_TRUE(says(describe(repair), {"1 exchanges of tracks undone"}));
}

TEST(Tracks, ThatComeBackUnderAnothersNameAreFound) {
    const std::vector<RecordedPoint> truth = swaying();
    std::vector<RecordedPoint> points = truth;
    for (const int p : {0, 3}) points[p].at.middleCols(60, 20).setConstant(std::nan(""));
    points[0].at.rightCols(120) = truth[3].at.rightCols(120);
    points[3].at.rightCols(120) = truth[0].at.rightCols(120);
    const TrackRepair repair = mend_tracks(points);
    EXPECT_EQ(repair.swaps, 1);
    EXPECT_EQ(repair.vanishings, 2);
    EXPECT_EQ(apart(points, truth), 0);
}

TEST(Tracks, ThatFlickerLoseTheirFlicker) {
    const std::vector<RecordedPoint> truth = swaying();
    std::vector<RecordedPoint> points = truth;
    points[2].at.middleCols(50, 3).colwise() += Vec3(0, 90, 0);
    const TrackRepair repair = mend_tracks(points);
    EXPECT_EQ(repair.flickers, 3);
    EXPECT_EQ(repair.swaps, 0);
    EXPECT_EQ(apart(points, truth), 0);
    EXPECT_TRUE(points[2].at.col(51).array().isNaN().all());
}

TEST(Tracks, ThatAreSoundStayAsTheyAre) {
    std::vector<RecordedPoint> points = swaying();
    EXPECT_EQ(describe(mend_tracks(points)), "");
    EXPECT_EQ(apart(points, swaying()), 0);
}

}  // namespace
}  // namespace palpate::identify
