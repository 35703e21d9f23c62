#include "identify/preflight/suspicions.h"

#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "identify/diagnosis/statistics/outliers/outliers.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/geometry/winding.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

constexpr double most_scales = 6;   // of the robust scale of all: one of many thousands by chance
constexpr double least_sigmas = 5;  // of the stated noise too: hardly one of a million by chance

struct ReadingOf {
    int state = 0, marker = 0, coordinates = 0;
    Vec3 error = Vec3::Zero();
    double sigma = 0;
};

std::vector<ReadingOf> by_reading(const Problem& problem, const Eigen::VectorXd& error_mm) {
    std::vector<ReadingOf> result(static_cast<std::size_t>(problem.readings()));
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (!problem.is_position(n)) continue;
        ReadingOf& one = result[static_cast<std::size_t>(problem.reading[n])];
        one.state = problem.state[n];
        one.marker = problem.channel(n);
        one.error[problem.coordinate[n] % 3] = error_mm[n];
        one.sigma = std::max(one.sigma, problem.sigma[n]);
        ++one.coordinates;
    }
    return result;
}

/// Products of the coordinates up to a degree (n x 1, 4, 10 or 20), of places about their mean, in their spread.
Eigen::MatrixXd products(const Points& places, int degree) {
    const Points about = places.rowwise() - places.colwise().mean();
    const Points x = about / std::max(about.cwiseAbs().maxCoeff(), 1e-12);
    std::vector<Eigen::VectorXd> columns;
    for (int a = 0; a <= degree; ++a)
        for (int b = 0; a + b <= degree; ++b)
            for (int c = 0; a + b + c <= degree; ++c)
                columns.emplace_back(x.col(0).array().pow(a) * x.col(1).array().pow(b) * x.col(2).array().pow(c));
    Eigen::MatrixXd all(x.rows(), std::ssize(columns));
    for (std::size_t i = 0; i < columns.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = columns[i];
    return all;
}

/// Errors without what is smooth over a state, as large as that may be: up to the third degree, with two readings a
/// coefficient and more. At the body's ends, where neighbours lie on one side, a slope would look like an error.
Eigen::VectorXd without_trend(const Problem& problem, const Eigen::VectorXd& error_mm) {
    std::map<std::pair<int, int>, std::vector<Eigen::Index>> rows;  // of an axis in a state
    for (Eigen::Index n = 0; n < problem.rows(); ++n)
        if (problem.is_position(n)) rows[{problem.state[n], problem.coordinate[n] % 3}].push_back(n);
    Eigen::VectorXd result = error_mm;
    for (const auto& [of, own] : rows) {
        constexpr std::array coefficients{1, 4, 10, 20};  // of polynomials in x, y, z up to each degree
        int degree = 0;
        while (degree < 3 && 2 * coefficients[static_cast<std::size_t>(degree) + 1] <= std::ssize(own)) ++degree;
        if (degree == 0) continue;
        Points places(std::ssize(own), 3);
        for (std::size_t i = 0; i < own.size(); ++i)
            places.row(static_cast<Eigen::Index>(i)) = problem.rest.row(problem.channel(own[i]));
        const Eigen::MatrixXd A = products(places, degree);
        const Eigen::VectorXd y = error_mm(own);
        const Eigen::VectorXd smooth = A * A.completeOrthogonalDecomposition().solve(y);
        result(own) = y - smooth;
    }
    return result;
}

/// Readings unlike their neighbours', where a state has enough of them to tell.
std::vector<Suspicion> rough_readings(const Problem& problem, const Eigen::VectorXd& error_mm,
                                      const std::vector<ReadingOf>& readings) {
    constexpr int least_readings = 8;  // as `roughness` asks for
    const Roughness found = roughness(problem, without_trend(problem, error_mm));
    std::map<int, int> in_state;
    std::map<int, int> of_marker;
    for (const ReadingOf& one : readings) {
        if (one.coordinates == 0) continue;
        ++in_state[one.state];
        ++of_marker[one.marker];
    }
    std::vector<Suspicion> rough;
    std::map<int, std::vector<Suspicion>> by_marker;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const ReadingOf& one = readings[i];
        if (one.coordinates < 3 || in_state[one.state] < least_readings) continue;
        const double sigmas = found.size[i] / one.sigma;
        if (found.size[i] > most_scales * found.scale && sigmas > least_sigmas)
            by_marker[one.marker].push_back({Suspect::rough, one.state, one.marker, -1, found.size[i], sigmas});
    }
    for (const auto& [marker, own] : by_marker) {
        constexpr int several = 3;  // two may fall on one marker by chance
        if (std::ssize(own) >= several && 2 * std::ssize(own) > of_marker[marker]) {
            Suspicion worst = *std::ranges::max_element(own, {}, &Suspicion::mm);
            worst.kind = Suspect::everywhere;
            worst.state = -1;
            rough.push_back(worst);
        } else {
            rough.insert(rough.end(), own.begin(), own.end());
        }
    }
    return rough;
}

/// Readings off the line between those before and after, in a probe of three times and more.
std::vector<Suspicion> jumps(const Problem& problem, const std::vector<ReadingOf>& readings) {
    std::map<std::pair<int, int>, std::vector<const ReadingOf*>> courses;  // of a marker in a probe, by state
    for (const ReadingOf& one : readings) {
        if (one.coordinates == 3)
            courses[{problem.stages[static_cast<std::size_t>(one.state)].probe, one.marker}].push_back(&one);
    }
    std::vector<Suspicion> bends;
    std::vector<double> sizes;
    for (const auto& [of, course] : courses) {
        for (std::size_t i = 1; i + 1 < course.size(); ++i) {
            const Vec3 bend = course[i]->error - 0.5 * (course[i - 1]->error + course[i + 1]->error);
            // A step of the course bends it at two places, a reading that is off by itself most where it lies.
            const Vec3 across = course[i + 1]->error - course[i - 1]->error;
            sizes.push_back(bend.norm());
            if (bend.norm() > across.norm())
                bends.push_back({Suspect::jump, course[i]->state, course[i]->marker, -1, bend.norm(),
                                 bend.norm() / course[i]->sigma});
        }
    }
    if (sizes.empty()) return {};
    const double scale = mesh::upper_median(sizes);
    std::erase_if(bends,
                  [&](const Suspicion& one) { return one.mm <= most_scales * scale || one.sigmas <= least_sigmas; });
    return bends;
}

}  // namespace

std::vector<Suspicion> suspicious_readings(const Problem& problem, const Eigen::VectorXd& error_mm) {
    const std::vector<ReadingOf> readings = by_reading(problem, error_mm);
    std::vector<Suspicion> result = rough_readings(problem, error_mm, readings);
    for (const Suspicion& jump : jumps(problem, readings)) {
        const bool is_told = std::ranges::any_of(result, [&](const Suspicion& one) {
            return one.marker == jump.marker && (one.state == jump.state || one.state < 0);
        });
        if (!is_told) result.push_back(jump);
    }
    std::ranges::stable_sort(result, std::greater{}, &Suspicion::mm);
    return result;
}

std::vector<Suspicion> markers_off_the_surface(const MeasurementSet& set) {
    constexpr double far = 0.02;  // of the longest side: more than a sticker or a stylus tip stands off
    if (set.rest_surface.triangles.rows() == 0) return {};
    const mesh::SurfaceTree tree(set.rest_surface);
    const double most = far * mesh::bounding_box(set.rest_surface.vertices).longest_side();
    std::vector<Suspicion> result;
    for (std::size_t m = 0; m < set.markers.size(); ++m) {
        const Marker& marker = set.markers[m];
        if (marker.anchor) continue;
        const double distance = tree.closest(marker.rest).distance;
        constexpr double half = 0.5;  // windings: 1 inside, 0 outside
        if (distance <= most || mesh::winding_number(set.rest_surface, marker.rest) > half) continue;
        result.push_back({Suspect::far, -1, static_cast<int>(m), -1, distance, 0});
    }
    std::ranges::stable_sort(result, std::greater{}, &Suspicion::mm);
    return result;
}

}  // namespace palpate::identify
