#include "identify/recordings/assembly/tracks/mend_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/recordings/assembly/tracks/assignment.h"
#include "mesh/types.h"

namespace palpate::identify {
namespace {

constexpr double suspect = 0.25;          // of the way to the nearest neighbour
constexpr double clearly_less = 0.5;      // of the squares
constexpr Eigen::Index blink = 5;         // frames
constexpr std::size_t most_tracks = 100;  // a choice of cost: tracks are compared in pairs, frame by frame

/// Where each track was last, and how far it may have gone since without suspicion.
class Tracks {
public:
    explicit Tracks(std::vector<RecordedPoint>& points) : points_(points), last_(3, std::ssize(points)) {
        last_.setConstant(std::numeric_limits<double>::quiet_NaN());
        seen_at_.assign(points.size(), -1);
    }

    TrackRepair mend() {
        take_out_flickers();
        const Eigen::Index frames = points_.front().at.cols();
        for (Eigen::Index f = 0; f < frames; ++f) {
            if (is_suspected(f)) give_anew(f);
            for (std::size_t i = 0; i < points_.size(); ++i) {
                if (!points_[i].at.col(f).allFinite()) continue;
                if (seen_at_[i] >= 0 && f - seen_at_[i] > 1) ++repair_.vanishings;
                last_.col(static_cast<Eigen::Index>(i)) = points_[i].at.col(f);
                seen_at_[i] = f;
            }
        }
        return repair_;
    }

private:
    /// Half the distance between what was last seen of a track and the nearest other one's, squared, at most.
    double allowed(std::size_t i) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < points_.size(); ++j) {
            const double away = (column(j) - column(i)).norm();
            if (j != i && std::isfinite(away)) nearest = std::min(nearest, away);
        }
        return suspect * nearest;
    }
    Vec3 column(std::size_t i) const { return last_.col(static_cast<Eigen::Index>(i)); }

    bool is_suspected(Eigen::Index f) const {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double step = (points_[i].at.col(f) - column(i)).norm();
            if (std::isfinite(step) && step > allowed(i)) return true;
        }
        return false;
    }

    /// All points of the frame to the tracks, by the least sum of squares; the tracks go on with what they are given.
    void give_anew(Eigen::Index f) {
        std::vector<std::size_t> tracks, seen;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (column(i).allFinite()) tracks.push_back(i);
            if (points_[i].at.col(f).allFinite() && column(i).allFinite()) seen.push_back(i);
        }
        if (seen.empty()) return;
        Eigen::MatrixXd cost(std::ssize(seen), std::ssize(tracks));
        for (std::size_t s = 0; s < seen.size(); ++s)
            for (std::size_t t = 0; t < tracks.size(); ++t)
                cost(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(t)) =
                    (points_[seen[s]].at.col(f) - column(tracks[t])).squaredNorm();
        const std::vector<int> given = least_assignment(cost);
        double as_it_is = 0, anew = 0;
        bool is_changed = false;
        for (std::size_t s = 0; s < seen.size(); ++s) {
            const std::size_t track = tracks[static_cast<std::size_t>(given[s])];
            as_it_is += (points_[seen[s]].at.col(f) - column(seen[s])).squaredNorm();
            anew += (points_[seen[s]].at.col(f) - column(track)).squaredNorm();
            is_changed = is_changed || track != seen[s];
        }
        if (!is_changed || anew > clearly_less * as_it_is) return;
        std::vector<std::size_t> source(points_.size());
        for (std::size_t i = 0; i < source.size(); ++i) source[i] = i;
        std::vector<char> is_given(points_.size(), 0);
        std::vector<std::size_t> left;
        for (std::size_t s = 0; s < seen.size(); ++s) {
            source[tracks[static_cast<std::size_t>(given[s])]] = seen[s];
            is_given[seen[s]] = 1;
        }
        // tracks whose slot went to another take one of the slots that none was given
        std::vector<char> has_source(points_.size(), 0);
        for (std::size_t s = 0; s < seen.size(); ++s) has_source[tracks[static_cast<std::size_t>(given[s])]] = 1;
        for (std::size_t i = 0; i < points_.size(); ++i)
            if (is_given[i] == 0) left.push_back(i);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (has_source[i] != 0) continue;
            const auto own = std::ranges::find(left, i);
            const auto taken = own != left.end() ? own : left.begin();
            if (taken == left.end()) continue;
            source[i] = *taken;
            left.erase(taken);
        }
        exchange_from(f, source);
        ++repair_.swaps;
    }

    void exchange_from(Eigen::Index f, const std::vector<std::size_t>& source) {
        const Eigen::Index rest = points_.front().at.cols() - f;
        std::vector<Eigen::Matrix3Xd> at, displacement;
        at.reserve(points_.size());
        displacement.reserve(points_.size());
        for (const RecordedPoint& point : points_) {
            at.emplace_back(point.at.rightCols(rest));
            displacement.emplace_back(point.displacement.cols() > 0 ? point.displacement.rightCols(rest).eval()
                                                                    : Eigen::Matrix3Xd(3, 0));
        }
        for (std::size_t i = 0; i < points_.size(); ++i) {
            points_[i].at.rightCols(rest) = at[source[i]];
            if (points_[i].displacement.cols() > 0 && displacement[source[i]].cols() > 0)
                points_[i].displacement.rightCols(rest) = displacement[source[i]];
        }
    }

    /// A track that jumps and is back where it was within a blink, while no other one is where it jumped to before.
    void take_out_flickers() {
        const Eigen::Index frames = points_.front().at.cols();
        for (std::size_t i = 0; i < points_.size(); ++i) {
            Eigen::Matrix3Xd& at = points_[i].at;
            for (Eigen::Index f = 1; f + 1 < frames; ++f) {
                const double gap = neighbour(i, f - 1);
                if (!((at.col(f) - at.col(f - 1)).norm() > suspect * gap)) continue;
                for (Eigen::Index back = f + 1; back <= std::min(f + blink, frames - 1); ++back) {
                    if (!((at.col(back) - at.col(f - 1)).norm() < 0.2 * (at.col(f) - at.col(f - 1)).norm())) continue;
                    if (!others_jump(i, f)) {
                        at.middleCols(f, back - f).setConstant(std::numeric_limits<double>::quiet_NaN());
                        repair_.flickers += static_cast<int>(back - f);
                    }
                    break;
                }
            }
        }
    }

    double neighbour(std::size_t i, Eigen::Index f) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < points_.size(); ++j) {
            const double away = (points_[j].at.col(f) - points_[i].at.col(f)).norm();
            if (j != i && std::isfinite(away)) nearest = std::min(nearest, away);
        }
        return nearest;
    }

    /// Another track goes to where this one was: they swap, and no one flickers.
    bool others_jump(std::size_t i, Eigen::Index f) const {
        const Vec3 was = points_[i].at.col(f - 1);
        const double jump = (points_[i].at.col(f) - was).norm();
        for (std::size_t j = 0; j < points_.size(); ++j)
            if (j != i && (points_[j].at.col(f) - was).norm() < 0.2 * jump) return true;
        return false;
    }

    std::vector<RecordedPoint>& points_;
    Eigen::Matrix3Xd last_;
    std::vector<Eigen::Index> seen_at_;
    TrackRepair repair_;
};

}  // namespace

TrackRepair mend_tracks(std::vector<RecordedPoint>& points) {
    if (points.size() < 2 || points.size() > most_tracks || points.front().at.cols() < 2) return {};
    return Tracks(points).mend();
}

std::string describe(const TrackRepair& repair) {
    std::string words;
    const auto add = [&](int count, const char* what) {
        if (count > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, what);
    };
    add(repair.swaps, "exchanges of tracks undone");
    add(repair.flickers, "readings of flickering points taken out");
    add(repair.vanishings, "gaps in tracks");
    return words;
}

}  // namespace palpate::identify
