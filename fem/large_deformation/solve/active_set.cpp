#include "fem/large_deformation/solve/active_set.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace palpate::fem {

namespace {

constexpr std::size_t most_in_step = 100;  // solutions, about four factors: the next step's costs one
constexpr int most_rounds = 20;            // few are needed, unless they go round in circles

}  // namespace

void ActiveSet::start(const Points& points) {
    led_to_.reset();
    held_.clear();
    for (const NearPoint& point : points)
        if (point.gap < 0) held_.emplace(point.id, point.normal);
}

void ActiveSet::hold(const LoadedBody& body, const Unknowns& unknowns, const Points& points, LowerMatrix& K) {
    held_.clear();
    for (const NearPoint& point : points) {
        const bool touches = point.gap < 0, holds = led_to_ ? std::ranges::binary_search(*led_to_, point.id) : touches;
        if (holds) held_.emplace(point.id, point.normal);
        if (holds != touches) body.add_touch(point, holds ? 1 : -1, unknowns, K);
    }
}

Eigen::VectorXd ActiveSet::held_force(const LoadedBody& body, const Unknowns& unknowns, const Eigen::VectorXd& r,
                                      const Points& points) const {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(std::ssize(unknowns.number()) * 3);
    for (NearPoint point : points) {
        const auto held = held_.find(point.id);
        const bool touches = point.gap < 0, holds = held != held_.end();
        if (touches == holds) continue;
        if (holds) point.normal = held->second;  // as the factor does
        body.add_push(point, (touches ? 1 : -1) * point.stiffness * point.gap, change);
    }
    return r + unknowns.gather(change);
}

Eigen::VectorXd ActiveSet::step(const LoadedBody& body, const Unknowns& unknowns, const Eigen::VectorXd& r,
                                const Points& now, const Inverse& H) {
    const Eigen::VectorXd free = H(held_force(body, unknowns, r, now));
    solutions_ = 1;
    Points points = now;
    const Eigen::Index count = std::ssize(points);
    Eigen::VectorXd side = Eigen::VectorXd::Ones(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto held = held_.find(points[i].id);
        if (held == held_.end()) continue;
        side[i] = -1;
        points[i].normal = held->second;
    }
    const auto openings = [&](const Eigen::VectorXd& step) {
        const Eigen::VectorXd all = unknowns.scatter(step);
        Eigen::VectorXd result(count);
        for (Eigen::Index i = 0; i < count; ++i) result[i] = body.opening(points[i], all);
        return result;
    };
    const auto push = [&](Eigen::Index i) {
        Eigen::VectorXd forces = Eigen::VectorXd::Zero(std::ssize(unknowns.number()) * 3);
        body.add_push(points[i], 1, forces);
        return unknowns.gather(forces);
    };
    Eigen::VectorXd b = openings(free);
    for (Eigen::Index i = 0; i < count; ++i) b[i] += points[i].gap;

    std::vector<Eigen::VectorXd> answer(points.size()), opened(points.size());  // H n_i, and what it opens
    Eigen::VectorXd step = free, gaps = b;
    std::vector<Eigen::Index> changed;
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<Eigen::Index> before = std::exchange(changed, {});
        std::vector<Eigen::Index> unsolved;
        for (Eigen::Index i = 0; i < count; ++i) {
            if (side[i] * gaps[i] >= 0) continue;
            changed.push_back(i);
            if (answer[i].size() == 0) unsolved.push_back(i);
        }
        if (changed == before || solutions_ + unsolved.size() > most_in_step) break;
        if (!unsolved.empty()) {
            solutions_ += unsolved.size();
            Eigen::MatrixXd pushes(unknowns.size(), std::ssize(unsolved));
            for (Eigen::Index j = 0; j < pushes.cols(); ++j) pushes.col(j) = push(unsolved[j]);
            const Eigen::MatrixXd answers = H(pushes);
            for (Eigen::Index j = 0; j < pushes.cols(); ++j) {
                answer[unsolved[j]] = answers.col(j);
                opened[unsolved[j]] = openings(answers.col(j));
            }
        }
        Eigen::MatrixXd A(std::ssize(changed), std::ssize(changed));
        for (Eigen::Index j = 0; j < A.cols(); ++j) {
            A.col(j) = opened[changed[j]](changed);
            A(j, j) += side[changed[j]] / points[changed[j]].stiffness;
        }
        const Eigen::VectorXd forces = A.partialPivLu().solve(-b(changed).eval());
        step = free;
        gaps = b;
        for (Eigen::Index j = 0; j < A.cols(); ++j) {
            step += forces[j] * answer[changed[j]];
            gaps += forces[j] * opened[changed[j]];
        }
    }
    led_to_.emplace();
    for (Eigen::Index i = 0; i < count; ++i)
        if (gaps[i] < 0) led_to_->push_back(points[i].id);
    return step;
}

}  // namespace palpate::fem
