#include "identify/models/tendon_friction.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <optional>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double friction_tolerance = 1e-7;  // of shares, and of a length drawn in: as well as equilibria are known
constexpr int most_friction_rounds = 40;     // what has come to no rest by then wanders

/// The next iterate of x = g(x), from those before and what g made of them. [Anderson 1965; Walker & Ni 2011]
class Acceleration {
public:
    Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& g) {
        const Eigen::VectorXd f = g - x;
        if (before_) {
            steps_.push_back(g - before_->g);
            changes_.push_back(f - before_->f);
            if (steps_.size() > window) {
                steps_.erase(steps_.begin());
                changes_.erase(changes_.begin());
            }
        }
        before_ = Round{g, f};
        if (steps_.empty()) return g;
        Eigen::MatrixXd F(f.size(), std::ssize(changes_)), G(f.size(), std::ssize(steps_));
        for (std::size_t k = 0; k < steps_.size(); ++k) {
            F.col(static_cast<Eigen::Index>(k)) = changes_[k];
            G.col(static_cast<Eigen::Index>(k)) = steps_[k];
        }
        return g - G * F.completeOrthogonalDecomposition().solve(f);
    }

private:
    static constexpr std::size_t window = 4;  // rounds that are kept: older ones are of another slope. A choice
    struct Round {
        Eigen::VectorXd g, f;
    };
    std::optional<Round> before_;
    std::vector<Eigen::VectorXd> steps_, changes_;
};

class FrictionTangent : public Tangent {
public:
    FrictionTangent(std::shared_ptr<const Tangent> held, const fem::TendonSliding& all)
        : held_(std::move(held)),
          D_(all.number_by_point),
          Y_(held_->solve(all.by_number)),
          S_(Eigen::MatrixXd::Identity(D_.rows(), D_.rows()) + D_ * Y_) {
        if (!S_.isInvertible())
            throw SolverFailure("the tendons' friction leaves no single way for the body to move: there is no tangent");
    }
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override {
        const Eigen::MatrixXd X = held_->solve(B);
        return X - Y_ * S_.solve(D_ * X);
    }
    double gigabytes() const override { return held_->gigabytes() + 8e-9 * static_cast<double>(D_.size() + Y_.size()); }
    const Tangent& held() const { return *held_; }

private:
    std::shared_ptr<const Tangent> held_;
    Eigen::MatrixXd D_, Y_;
    Eigen::FullPivLU<Eigen::MatrixXd> S_;
};

}  // namespace

bool rub(const std::vector<fem::TendonPull>& tendons) {
    return std::ranges::any_of(tendons, [](const fem::TendonPull& one) { return one.coefficient != 0; });
}

FrictionIteration::FrictionIteration(std::vector<fem::TendonPull> tendons, Settle settle, Follow follow)
    : tendons_(std::move(tendons)), settle_(std::move(settle)), follow_(std::move(follow)), unit_(0) {
    for (const fem::TendonPull& one : tendons_)
        if (one.actuator->by_length) unit_ = std::max(unit_, std::abs(one.value));
    // A cable of the length L in a body of the section A is longer than drawn in by some A / L^2 over a thousand: its
    // tension is known as well as that.
    unit_ = unit_ > 0 ? 1e-4 * unit_ : 1;
}

Eigen::VectorXd FrictionIteration::numbers_at(const Eigen::VectorXd& q) const {
    std::vector<double> x;
    for (const fem::TendonPull& one : tendons_) {
        const fem::TendonFriction friction = follow_(one, q);
        x.insert(x.end(), friction.shares.begin(), friction.shares.end());
        x.push_back(friction.taken_up / unit_);
    }
    return Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x));
}

std::vector<fem::TendonPull> FrictionIteration::held_at(const Eigen::VectorXd& numbers) const {
    std::vector<fem::TendonPull> held = tendons_;
    Eigen::Index at = 0;
    for (fem::TendonPull& one : held) {
        const Eigen::Index segments = one.actuator->path.rows() - 1;
        one.friction = fem::TendonFriction{numbers.segment(at, segments), unit_ * numbers[at + segments]};
        at += segments + 1;
    }
    return held;
}

Eigen::VectorXd FrictionIteration::equilibrium(const Eigen::VectorXd& first, const Eigen::VectorXd* start) const {
    Eigen::VectorXd x = numbers_at(start ? *start : first), q;
    Acceleration acceleration;
    for (int round = 0; round < most_friction_rounds; ++round) {
        q = settle_(held_at(x), round > 0 ? &q : start);
        const Eigen::VectorXd made = numbers_at(q);
        if ((made - x).cwiseAbs().maxCoeff() <= friction_tolerance) return q;
        x = acceleration.next(x, made);
    }
    throw SolverFailure(
        "the friction of tendons and the body's shape come to no rest together; take a smaller coefficient, or draw in "
        "less");
}

fem::TendonSliding together(const std::vector<fem::TendonSliding>& tendons, Eigen::Index dofs) {
    Eigen::Index count = 0;
    for (const fem::TendonSliding& one : tendons) count += one.by_number.cols();
    fem::TendonSliding all{Eigen::MatrixXd(dofs, count), Eigen::MatrixXd(count, dofs)};
    Eigen::Index at = 0;
    for (const fem::TendonSliding& one : tendons) {
        all.by_number.middleCols(at, one.by_number.cols()) = one.by_number;
        all.number_by_point.middleRows(at, one.by_number.cols()) = one.number_by_point;
        at += one.by_number.cols();
    }
    return all;
}

std::shared_ptr<const Tangent> tangent_with_friction(std::shared_ptr<const Tangent> held,
                                                     const fem::TendonSliding& all) {
    if (all.by_number.cols() == 0) return held;
    return std::make_shared<FrictionTangent>(std::move(held), all);
}

const Tangent& with_friction_held(const Tangent& tangent) {
    const auto* own = dynamic_cast<const FrictionTangent*>(&tangent);
    return own ? own->held() : tangent;
}

}  // namespace palpate::identify
