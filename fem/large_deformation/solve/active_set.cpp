#include "fem/large_deformation/solve/active_set.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace palpate::fem {

namespace {

constexpr std::size_t most_in_step = 100;  // solutions, about four factors: the rest is left to the next step
constexpr int most_rounds = 20;            // few are needed, unless they go round in circles

/// What unit forces along the points' normals do: the steps H n_i, and by how much these open all gaps. Solved for as
/// they are asked for.
class Answers {
public:
    Answers(const LoadedBody& body, const Unknowns& unknowns, const ActiveSet::Points& points,
            const ActiveSet::Inverse& H)
        : body_(body), unknowns_(unknowns), points_(points), H_(H), steps_(points.size()), openings_(points.size()) {}

    const Eigen::VectorXd& step(Eigen::Index i) const { return steps_[i]; }
    const Eigen::VectorXd& openings(Eigen::Index i) const { return openings_[i]; }
    Eigen::VectorXd openings_of(const Eigen::VectorXd& step) const {
        const Eigen::VectorXd all = unknowns_.scatter(step);
        Eigen::VectorXd result(std::ssize(points_));
        for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = body_.opening(points_[i], all);
        return result;
    }
    /// False, and nothing done, where these take more solutions than are `left`, which falls by those.
    bool solve(std::vector<Eigen::Index> which, std::size_t& left) {
        std::erase_if(which, [&](Eigen::Index i) { return steps_[i].size() > 0; });
        if (which.size() > left) return false;
        if (which.empty()) return true;
        left -= which.size();
        Eigen::MatrixXd X(unknowns_.size(), std::ssize(which));
        for (Eigen::Index j = 0; j < X.cols(); ++j) {
            Eigen::VectorXd push = Eigen::VectorXd::Zero(std::ssize(unknowns_.number()) * 3);
            body_.add_push(points_[which[j]], 1, push);
            X.col(j) = unknowns_.gather(push);
        }
        X = H_(X);
        for (Eigen::Index j = 0; j < X.cols(); ++j) {
            steps_[which[j]] = X.col(j);
            openings_[which[j]] = openings_of(X.col(j));
        }
        return true;
    }

private:
    const LoadedBody& body_;
    const Unknowns& unknowns_;
    const ActiveSet::Points& points_;
    const ActiveSet::Inverse& H_;
    std::vector<Eigen::VectorXd> steps_, openings_;
};

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
    Points points = now;
    const Eigen::Index count = std::ssize(points);
    Eigen::VectorXd side = Eigen::VectorXd::Ones(count), b(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        b[i] = points[i].gap;
        const auto held = held_.find(points[i].id);
        if (held == held_.end()) continue;
        side[i] = -1;
        points[i].normal = held->second;
    }
    Answers answers(body, unknowns, points, H);
    const Eigen::VectorXd free = H(held_force(body, unknowns, r, now));
    b += answers.openings_of(free);

    std::size_t left = most_in_step;
    Eigen::VectorXd step = free, gaps = b;
    std::vector<Eigen::Index> changed;
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<Eigen::Index> before = std::exchange(changed, {});
        for (Eigen::Index i = 0; i < count; ++i)
            if (side[i] * gaps[i] < 0) changed.push_back(i);
        if (changed == before || !answers.solve(changed, left)) break;
        Eigen::MatrixXd A(std::ssize(changed), std::ssize(changed));
        for (Eigen::Index j = 0; j < A.cols(); ++j) {
            A.col(j) = answers.openings(changed[j])(changed);
            A(j, j) += side[changed[j]] / points[changed[j]].stiffness;
        }
        const Eigen::VectorXd forces = A.partialPivLu().solve(-b(changed).eval());
        step = free;
        gaps = b;
        for (Eigen::Index j = 0; j < A.cols(); ++j) {
            step += forces[j] * answers.step(changed[j]);
            gaps += forces[j] * answers.openings(changed[j]);
        }
    }
    solutions_ = 1 + most_in_step - left;
    led_to_.emplace();
    for (Eigen::Index i = 0; i < count; ++i)
        if (gaps[i] < 0) led_to_->push_back(points[i].id);
    return step;
}

}  // namespace palpate::fem
