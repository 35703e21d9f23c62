#include "skeleton/construction/shape/core.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace palpate::skeleton {
namespace {

// V / r^3 below this: a lump all over. A ball has 4.2, a cube 8, a square bar 4 per width, a round limb 6.3 per
// diameter: one of three diameters errs as little as a chain as filled with ten times the spheres.
constexpr double lump = 16;
constexpr double view = 4;            // a neighbourhood reaches this many radii
constexpr double runs_on = 0.42;      // a direction counts whose variance is at least this share of the largest
constexpr double touched = 1.002;     // of a ball's squared radius: its own touching points count, which rounding moves
constexpr double alike_radius = 0.9;  // of a ball's radius: others as large stand for the same part of the body

// A ball is stood for by one before it that is hardly larger and whose centre is this near, as shares of its radius
// (and of its square): choices between detail and the cost of looking round each.
constexpr double as_large = 0.95, as_near_squared = 0.04;

// The way from a section's edge leads on where the next ball is so many times as large: between the 1.1 of a limb that
// tapers by a tenth and the 3.4 of a square's edge. By that factor each, eight steps reach balls 8 times as large.
constexpr double leads_on = 1.3;
constexpr int most_steps = 8;

// A limb's section, over r^2: between a circle's, pi, and a square's, 4.
constexpr double limb_section = 3.5;
constexpr double least_ball = 0.75;  // of the limbs' mean radius: smaller ones are those of edges and ends
// Of the volume: up to the first of another kind is a limb's end or a plate's rim, and the second more is a part;
// between them it counts in proportion, so that the number of spheres does not leap.
constexpr double end_share = 0.05, part_over_end = 0.1;
// By default, choices between error and cost: a plate or lump has so many spheres, a limb so many from the support to
// its far end, but not closer together or further apart than these shares of its radius.
constexpr double spheres_of_plate = 60, spheres_of_lump = 120, spheres_along = 14;
constexpr double least_apart = 0.6, most_apart = 2;
constexpr int least_spheres = 4;
constexpr int bisections = 60;  // to the last digit: a double has 53 bits

// Medial balls, largest first.
struct Balls {
    Eigen::Array<double, Eigen::Dynamic, 3> centers;
    Eigen::ArrayXd radii;

    explicit Balls(const MedialAxis& axis) : centers(axis.centers.rows(), 3), radii(axis.radii.size()) {
        std::vector<int> order(axis.radii.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return axis.radii(i) > axis.radii(j); });
        for (std::size_t i = 0; i < order.size(); ++i) {
            centers.row(static_cast<Eigen::Index>(i)) = axis.centers.row(order[i]);
            radii(static_cast<Eigen::Index>(i)) = axis.radii(order[i]);
        }
    }

    Vec3 center(int ball) const { return centers.row(ball).matrix(); }

    double squared_distance(int ball, const Vec3& point) const { return (center(ball) - point).squaredNorm(); }

    // From the first `count` balls.
    Eigen::ArrayXd squared_distances(Eigen::Index count, const Vec3& point) const {
        return (centers.col(0).head(count) - point.x()).square() + (centers.col(1).head(count) - point.y()).square() +
               (centers.col(2).head(count) - point.z()).square();
    }

    // The largest ball that holds a point; where none does (in a sharp corner), the one that comes nearest.
    int largest_at(const Vec3& point) const {
        const auto n = static_cast<int>(radii.size());
        for (int i = 0; i < n; ++i) {
            if (squared_distance(i, point) <= touched * radii(i) * radii(i)) return i;
        }
        Eigen::Index nearest = 0;
        (squared_distances(n, point).sqrt() - radii).minCoeff(&nearest);
        return static_cast<int>(nearest);
    }

    // Of the balls that hold a point and are about as large as the given one: that with the nearest centre.
    int nearest_like(int ball, const Vec3& point) const {
        const auto smaller = [&](double radius, double least) { return radius >= least; };
        const auto end = std::lower_bound(radii.begin(), radii.end(), alike_radius * radii(ball), smaller);
        const Eigen::ArrayXd squared = squared_distances(end - radii.begin(), point);
        int best = ball;
        double least = squared_distance(ball, point);
        for (int i = 0; i < squared.size(); ++i) {
            if (squared(i) >= least || squared(i) > radii(i) * radii(i)) continue;
            best = i;
            least = squared(i);
        }
        return best;
    }

    // Balls of about the same place and size as one before them are stood for by that one.
    std::vector<int> representatives(const std::vector<char>& used) const {
        std::vector<int> stands(used.size()), kept;
        for (int b = 0; b < std::ssize(used); ++b) {
            stands[b] = b;
            if (!used[b]) continue;
            const auto alike = [&](int k) {
                return radii(b) > as_large * radii(k) &&
                       squared_distance(k, center(b)) < as_near_squared * radii(k) * radii(k);
            };
            const auto found = std::find_if(kept.begin(), kept.end(), alike);
            if (found != kept.end()) {
                stands[b] = *found;
            } else {
                kept.push_back(b);
            }
        }
        return stands;
    }
};

// Which ball stands for the body round a point. From an edge of the section the way leads over small balls there, each
// to the largest one that holds its centre: 3.4 times as large at a square's edge, but only 1.1 times in a limb that
// tapers by a tenth, up which the way must not lead. `onward`: that larger ball of each, -1 where not known yet.
int ball_of(const Balls& balls, const Vec3& point, std::vector<int>& onward) {
    Vec3 inner = point;
    int ball = balls.largest_at(point);
    for (int step = 0; step < most_steps; ++step) {
        const Vec3 center = balls.center(ball);
        if (onward[ball] < 0) onward[ball] = balls.largest_at(center);
        const int larger = onward[ball];
        if (balls.radii(larger) < leads_on * balls.radii(ball)) break;
        ball = larger;
        inner = center;
    }
    return balls.nearest_like(ball, inner);
}

// Finds out which way the body runs on round a ball, by its moments within reach, as far as it hangs together there;
// far parts count less. `seen`: the last stamp of each tetrahedron.
void look_round(const TetGraph& graph, int start, Neighborhood& here, std::vector<int>& seen, int stamp) {
    const double reach = view * here.radius;
    const Vec3 center = here.middle;
    double weight = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    std::vector<int> front{start};
    seen[start] = stamp;
    for (std::size_t i = 0; i < front.size(); ++i) {
        const int t = front[i];
        const Vec3 d = graph.centers.row(t).transpose() - center;
        const double fade = std::max(0., 1 - d.squaredNorm() / (reach * reach));
        const double w = graph.volumes(t) * fade * fade;
        weight += w;
        first += w * d;
        second += w * d * d.transpose();
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0 || seen[u] == stamp) continue;
            if ((graph.centers.row(u).transpose() - center).squaredNorm() > reach * reach) continue;
            seen[u] = stamp;
            front.push_back(u);
        }
    }
    if (!(weight > 0)) return;
    here.middle = center + first / weight;
    // About the ball's centre, not about the mean: so a limb's end looks like its middle.
    const Eigen::SelfAdjointEigenSolver<Mat3> spread(second / weight);
    for (int k = 0; k < 2; ++k) {
        if (spread.eigenvalues()(k) >= runs_on * spread.eigenvalues()(2)) break;
        const Vec3 thin = spread.eigenvectors().col(k);
        here.along -= thin * thin.transpose();
        --here.dimensions;
    }
}

void collapse(const TetGraph& graph, Core& core) {
    core.at.resize(graph.size(), 3);
    for (int t = 0; t < graph.size(); ++t) core.at.row(t) = core.of(t).collapse(graph.centers.row(t));
}

}  // namespace

double Neighborhood::section() const {
    return dimensions == 1 ? limb_section * radius * radius : dimensions == 2 ? 2 * radius : 1;
}

Core find_core(const TetGraph& graph, const MedialAxis& axis) {
    const Balls balls(axis);
    const bool filled = graph.volumes.sum() < lump * std::pow(balls.radii(0), 3);
    std::vector<int> ball(graph.size()), onward(balls.radii.size(), -1);
    std::vector<char> used(balls.radii.size());
    for (int t = 0; t < graph.size(); ++t) {
        const Vec3 center = graph.centers.row(t);
        ball[t] = filled ? balls.largest_at(center) : ball_of(balls, center, onward);
        used[ball[t]] = 1;
    }
    const std::vector<int> stands = balls.representatives(used);
    std::map<int, int> nearest;  // of each ball in use: the tetrahedron at its centre
    for (int t = 0; t < graph.size(); ++t) {
        const int b = ball[t] = stands[ball[t]];
        const auto [found, fresh] = nearest.try_emplace(b, t);
        const Vec3 center = graph.centers.row(t), best = graph.centers.row(found->second);
        if (!fresh && balls.squared_distance(b, center) < balls.squared_distance(b, best)) found->second = t;
    }

    Core core;
    core.neighborhood.resize(graph.size());
    std::map<int, int> index;
    std::vector<int> seen(graph.size(), -1);
    for (const auto& [b, start] : nearest) {
        const int k = index[b] = static_cast<int>(core.neighborhoods.size());
        Neighborhood here;
        here.middle = balls.center(b);
        here.radius = balls.radii(b);
        if (!filled) look_round(graph, start, here, seen, k);
        core.neighborhoods.push_back(here);
    }
    for (int t = 0; t < graph.size(); ++t) core.neighborhood[t] = index.at(ball[t]);
    collapse(graph, core);
    return core;
}

Core fill_core(const TetGraph& graph, const Core& core) {
    Core filled = core;
    for (Neighborhood& n : filled.neighborhoods) {
        n.along = Mat3::Identity();
        n.dimensions = 3;
    }
    collapse(graph, filled);
    return filled;
}

Eigen::VectorXd sphere_shares(const Eigen::VectorXd& volumes, const Core& core, double spacing) {
    Eigen::VectorXd shares(volumes.size());
    for (int t = 0; t < volumes.size(); ++t) {
        const Neighborhood& n = core.of(t);
        shares(t) = volumes(t) / (n.section() * std::pow(spacing, n.dimensions));
    }
    return shares;
}

double spacing_of_spheres(const Eigen::VectorXd& volumes, const Core& core, int spheres) {
    // Lengths of limbs, areas of plates, volumes of lumps: sum_d extent_d / spacing^d = spheres.
    Vec3 extent = Vec3::Zero();
    for (int t = 0; t < volumes.size(); ++t) extent(core.of(t).dimensions - 1) += volumes(t) / core.of(t).section();
    double low = 0, high = std::max({3 * extent(0) / spheres, std::sqrt(3 * extent(1) / spheres),
                                     std::cbrt(3 * extent(2) / spheres)});
    for (int i = 0; i < bisections; ++i) {
        const double h = (low + high) / 2;
        const double count = extent(0) / h + extent(1) / (h * h) + extent(2) / (h * h * h);
        (count > spheres ? low : high) = h;
    }
    return high;
}

int default_spheres(const TetGraph& graph, const Eigen::VectorXd& volumes, const Core& core, double reach) {
    Vec3 share = Vec3::Zero();       // of the volume, by dimensions
    double radius = 0, squares = 0;  // of the limbs: of their balls, of their material's distance from the core
    for (int t = 0; t < volumes.size(); ++t) {
        const Neighborhood& n = core.of(t);
        share(n.dimensions - 1) += volumes(t);
        if (n.dimensions > 1) continue;
        radius += volumes(t) * n.radius;
        squares += volumes(t) * (graph.centers.row(t) - core.at.row(t)).squaredNorm();
    }
    double length = 0;  // of the limbs
    if (share(0) > 0) {
        // Edges and ends have small balls of their own, which would count as much length.
        radius /= share(0);
        for (int t = 0; t < volumes.size(); ++t) {
            const double r = std::max(core.of(t).radius, least_ball * radius);
            if (core.of(t).dimensions == 1) length += volumes(t) / Neighborhood{.dimensions = 1, .radius = r}.section();
        }
        // Balls miss the middle of a section by up to their spacing; its moment tells its size on the whole:
        // a circle's mean square is r^2 / 2, so its area 2 pi times that, and a square's nearly.
        const double size = std::sqrt(2 * std::numbers::pi / limb_section * squares / share(0));
        length *= std::pow(radius / size, 2);
        radius = size;
    }

    share /= share.sum();
    Vec3 part;
    for (int d = 0; d < 3; ++d) part(d) = share(d) * std::clamp((share(d) - end_share) / part_over_end, 0., 1.);
    part /= part.sum();
    double count = spheres_of_plate * part(1) + spheres_of_lump * part(2);
    if (part(0) > 0)
        count +=
            part(0) / share(0) * length / std::clamp(reach / spheres_along, least_apart * radius, most_apart * radius);
    return std::max(least_spheres, static_cast<int>(std::lround(count)));
}

double mean_radius(const Eigen::VectorXd& volumes, const Core& core) {
    double sum = 0;
    for (int t = 0; t < volumes.size(); ++t) sum += volumes(t) * core.of(t).radius;
    return sum / volumes.sum();
}

}  // namespace palpate::skeleton
