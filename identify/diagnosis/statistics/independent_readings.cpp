#include "identify/diagnosis/statistics/independent_readings.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

bool are_parallel(const Vec3& a, const Vec3& b) {
    constexpr double parallel = 0.999;  // cosine: within 2.6 degrees
    return std::abs(a.dot(b)) >= parallel * a.norm() * b.norm() && a.isZero(0) == b.isZero(0);
}

/// The same load but for its size and sign?
bool is_same_way(const Action& a, const Action& b) {
    const auto same_motion = [](const mesh::ToolMotion& one, const mesh::ToolMotion& other) {
        return one.tool == other.tool && are_parallel(known_part(one.translation), known_part(other.translation)) &&
               are_parallel(known_part(one.rotation), known_part(other.rotation));
    };
    return are_parallel(a.gravity, b.gravity) && (a.pressure == 0) == (b.pressure == 0) &&
           std::ranges::equal(a.motions, b.motions, same_motion) &&
           std::ranges::equal(a.settings, b.settings, {}, &mesh::ActuatorSetting::actuator,
                              &mesh::ActuatorSetting::actuator) &&
           std::ranges::equal(a.contacts, b.contacts, [](const mesh::Contact& one, const mesh::Contact& other) {
               return one.point == other.point && are_parallel(one.force, other.force);
           });
}

/// How large a load is, next to others of its way.
double size_of(const Action& action) {
    if (!action.contacts.empty()) return action.contacts.front().force.sum();
    if (!action.motions.empty()) {
        const mesh::ToolMotion& motion = action.motions.front();
        return known_part(motion.translation).sum() + known_part(motion.rotation).sum();
    }
    if (!action.settings.empty()) return action.settings.front().value;
    return action.pressure != 0 ? action.pressure : action.gravity.sum();
}

/// Terms of a power series in t that leave no more than noise of displacements in sigmas: chi^2 within two standard
/// deviations of what chance leaves.
int terms_needed(const std::vector<std::pair<double, double>>& curve) {
    const auto L = std::ssize(curve);
    double largest = 0;
    for (const auto& [t, d] : curve) largest = std::max(largest, std::abs(t));
    constexpr Eigen::Index most_terms = 6;  // design choice: what a response in so many powers leaves counts as no more
    Eigen::MatrixXd powers(L, std::min(L, most_terms));
    Eigen::VectorXd d(L);
    for (Eigen::Index i = 0; i < L; ++i) {
        const double t = largest > 0 ? curve[i].first / largest : 1;
        d[i] = curve[i].second;
        for (Eigen::Index p = 0; p < powers.cols(); ++p) powers(i, p) = std::pow(t, p + 1);
    }
    for (Eigen::Index terms = 0; terms < powers.cols(); ++terms) {
        const auto left = static_cast<double>(L - terms);
        const Eigen::VectorXd rest =
            terms == 0 ? d : d - powers.leftCols(terms) * powers.leftCols(terms).householderQr().solve(d).eval();
        if (rest.squaredNorm() <= left + 2 * std::sqrt(2 * left)) return static_cast<int>(terms);
    }
    return static_cast<int>(powers.cols());
}

}  // namespace

int independent_readings(const Problem& problem) {
    std::vector<int> load_direction(problem.actions.size());  // the first action of the same way
    for (std::size_t k = 0; k < load_direction.size(); ++k) {
        const auto first = std::ranges::find_if(
            problem.actions, [&](const Action& other) { return is_same_way(problem.actions[k], other); });
        load_direction[k] = static_cast<int>(first - problem.actions.begin());
    }
    std::map<std::pair<int, int>, std::vector<std::pair<double, double>>> curves;  // way, coordinate
    const Eigen::VectorXd moved = problem.displacement().cwiseQuotient(problem.sigma);
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int k = problem.action[n];
        curves[{load_direction[k], problem.coordinate[n]}].emplace_back(size_of(problem.actions[k]), moved[n]);
    }
    int count = 0;
    for (const auto& [of, curve] : curves) count += terms_needed(curve);
    return count;
}

}  // namespace palpate::identify
