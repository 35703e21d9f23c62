#include "skeleton/runtime/solver/solver.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "skeleton/blocks/tangent_shift.h"
#include "skeleton/model/state.h"
#include "skeleton/model/turning_curvature.h"

namespace palpate::runtime {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
// An old factor serves on for as long as two corrections, with what is learnt on the way, shrink to this.
constexpr double slow = 0.8;
// Factors that cost as much as so many solutions are dear: old ones are kept in equilibria too, whose corrections are
// large.
constexpr double expensive = 10;
// Steps end where the tangent tells too little: at so many radians of a sphere, at this share of a link's length by
// which its ends part. Choices: longer ones fail more often in slender bodies, shorter ones take more of them.
constexpr double most_turn = 0.5, most_parting = 0.5;
constexpr double tiny = 1e-7;      // of the mean link length: Newton's method has arrived, slopes tell no more
constexpr int most_halvings = 12;  // a share of 1/4096: where that is not enough, another direction is due
// Of the slope at the start: on the way up again behind the minimum, and on the way down a cliff.
constexpr double most_slope_left = 0.5, most_steepening = 10;

}  // namespace

Solver::Solver(ForceField& field, int contacts, Rig& rig) : field_(field), rig_(rig), matrix_(0, {}) {
    const skeleton::Model& model = field.model();
    const int n = static_cast<int>(model.spheres.size());
    for (int i = 0; i < n; ++i) {
        block_of_.push_back(field.moves()[i] ? static_cast<int>(free_.size()) : -1);
        if (field.moves()[i]) free_.push_back(i);
        const Eigen::SelfAdjointEigenSolver<Mat3> principal(model.spheres[i].inertia);
        axes_.push_back(principal.eigenvectors());
        spread_.emplace_back(0.5 * principal.eigenvalues().sum() - principal.eigenvalues().array());
    }
    double sum = 0;
    for (const skeleton::Link& link : model.links) sum += link.length;
    if (!model.links.empty()) length_ = sum / static_cast<double>(model.links.size());
    metric_ << 1, 1, 1, length_ * length_, length_ * length_, length_ * length_;

    std::vector<std::array<int, 2>> couplings;
    for (const auto& [a, b] : field.pairs()) {
        const bool coupled = a != b && block_of_[a] >= 0 && block_of_[b] >= 0;
        coupling_of_.push_back(coupled ? static_cast<int>(couplings.size()) : -1);
        if (coupled) couplings.push_back({block_of_[a], block_of_[b]});
    }
    matrix_ = skeleton::BlockCholesky(static_cast<int>(free_.size()), couplings);
    branches_ = skeleton::Branches(model.links, field.moves());

    const auto size = static_cast<Eigen::Index>(6 * free_.size());
    for (Vector* v : {&net_, &direction_, &there_}) v->setZero(size);
    bfgs_ = LimitedMemoryBfgs(size);
    springs_ = Springs(block_of_, size, contacts);
    stiffened_ = StiffenedMatrix(block_of_, size);
    const std::size_t rows = static_cast<std::size_t>(row_length) * row_count(model);
    for (SphereRows* r : {&force_, &velocity_, &trial_}) r->assign(rows, 0.0);
    x_predicted_.resize(n);
    R_predicted_.resize(n);
}

// Where the spheres would be without forces. The drag alpha divides velocities by 1 + alpha h, and multiplies masses.
void Solver::predict(const Step& step, const double* start, const double* velocity, double* pose) {
    const double share = step.h / (1 + step.alpha * step.h);
    for (const int i : free_) {
        const Eigen::Quaterniond q = skeleton::quaternion_of(share * turns_of(velocity, i)) * orientation_of(start, i);
        x_predicted_[i] = moves_of(start, i) + share * moves_of(velocity, i);
        R_predicted_[i] = q.toRotationMatrix();
        if (!step.extrapolate) continue;
        moves_of(pose, i) = x_predicted_[i];
        Eigen::Map<Eigen::Vector4d>(pose + row_length * i + 4) = q.coeffs().normalized();
    }
}

void Solver::set_rates(const Step& step, const double* start, const double* pose) {
    for (const int i : free_) {
        const Mat3 turn =
            orientation_of(pose, i).toRotationMatrix() * orientation_of(start, i).toRotationMatrix().transpose();
        Eigen::Map<Vec3> v = moves_of(velocity_.data(), i), w = turns_of(velocity_.data(), i);
        v = (moves_of(pose, i) - moves_of(start, i)) / step.h;
        w = skeleton::rotation_vector(turn) / step.h;
    }
}

// Inertia is a potential: 1/2 m |x - x*|^2 / h^2, and the same of the mass along the principal axes u_j at moments J_j,
// sum_j 1/2 J_j |u_j - u_j*|^2 / h^2, whose torque is sum_j J_j u_j x u_j* / h^2.
void Solver::balance(const Step& step, const std::vector<ContactState*>& contacts, const double* start,
                     const double* pose, Vector& net) {
    Rates rates;
    if (step.h > 0 && step.beta > 0) {
        set_rates(step, start, pose);
        rates = {velocity_.data(), step.beta};
    }
    field_.evaluate(pose, rates, force_.data());
    for (ContactState* contact : contacts) {
        if (!contact->acts()) continue;
        contact->at.place(pose);
        contact->at.add_force(contact->effective_force(), force_.data());
    }
    rig_.add_forces(pose, force_.data());
    const double by = step.h > 0 ? (1 + step.alpha * step.h) / (step.h * step.h) : 0;
    for (std::size_t f = 0; f < free_.size(); ++f) {
        const int i = free_[f];
        auto own = net.segment<6>(static_cast<Eigen::Index>(6 * f));
        own << moves_of(force_.data(), i), turns_of(force_.data(), i);
        if (by == 0) continue;
        own.head<3>() -= by * field_.model().spheres[i].mass * (moves_of(pose, i) - x_predicted_[i]);
        const Mat3 u = orientation_of(pose, i).toRotationMatrix() * axes_[i], to = R_predicted_[i] * axes_[i];
        for (int j = 0; j < 3; ++j) own.tail<3>() += by * spread_[i][j] * u.col(j).cross(to.col(j));
    }
}

void Solver::assemble(double share, const double* pose) {
    const std::vector<ForceField::Block>& K = field_.curvature(pose);
    matrix_.set_zero();
    stiffest_ = 0;
    for (std::size_t p = 0; p < K.size(); ++p) {
        const auto [a, b] = field_.pairs()[p];
        if (coupling_of_[p] >= 0) matrix_.add_coupling(coupling_of_[p], share * K[p]);
        if (a != b || block_of_[a] < 0) continue;
        matrix_.add_diagonal(block_of_[a], share * K[p]);
        stiffest_ = std::max(stiffest_, share * K[p].diagonal().cwiseQuotient(metric_).maxCoeff());
    }
}

// Factors the tangent with the least shift tried, from `shift` upwards, that makes it positive definite.
bool Solver::factor(const Step& step, const double* pose, double& shift) {
    factored_ = false;
    assemble(step.h > 0 ? 1 + step.beta / step.h : 1, pose);
    const double by = step.h > 0 ? (1 + step.alpha * step.h) / (step.h * step.h) : 0;
    for (std::size_t f = 0; by > 0 && f < free_.size(); ++f) {
        const int i = free_[f];
        ForceField::Block inertia = ForceField::Block::Zero();
        inertia.topLeftCorner<3, 3>().diagonal().setConstant(by * field_.model().spheres[i].mass);
        const Mat3 u = orientation_of(pose, i).toRotationMatrix() * axes_[i], to = R_predicted_[i] * axes_[i];
        for (int j = 0; j < 3; ++j) {
            inertia.bottomRightCorner<3, 3>() -= by * spread_[i][j] * skeleton::turning_curvature(to.col(j), u.col(j));
        }
        matrix_.add_diagonal(static_cast<int>(f), inertia);
    }
    while (matrix_.factor(shift, metric_)) {
        shift = skeleton::larger_shift(shift, stiffest_);
        if (!skeleton::can_shift(shift, stiffest_)) return false;
    }
    factored_ = true;
    bfgs_.forget();
    factored_h_ = step.h;
    factored_alpha_ = step.alpha;
    factored_beta_ = step.beta;
    forget_contacts();
    return true;
}

bool Solver::factor_is_expensive() const { return matrix_.cost_in_solutions() > expensive; }

// direction_ <- H net_, H the factored inverse with the springs of contacts and what tools and cables resist now, or,
// where they do not, what steps have told since.
void Solver::correct(const std::vector<ContactState*>& contacts, const double* pose) {
    if (!springs_.known()) springs_.take(matrix_, contacts, pose);
    direction_ = net_;
    const auto solve = [&](double* v) { springs_.solve(matrix_, v); };
    stiff_.clear();
    rig_.add_rows(pose, stiff_);
    if (!stiff_.rows.empty()) {
        bfgs_.forget();  // it knows of other ones
        stiffened_.take(stiff_, solve);
        solve(direction_.data());
        stiffened_.correct(direction_);
        return;
    }
    bfgs_.solve(direction_, [&](Vector& v) { solve(v.data()); });
}

// No sphere turns by more than half a radian at once, no link's ends part by more than half its length.
double Solver::step_limit(const double* from) const {
    double times_too_long = 1;
    for (std::size_t f = 0; f < free_.size(); ++f) {
        times_too_long =
            std::max(times_too_long, direction_.segment<3>(static_cast<Eigen::Index>(6 * f + 3)).norm() / most_turn);
    }
    for (const skeleton::Link& link : field_.model().links) {
        const Eigen::Matrix<double, 6, 1> own = direction_of(link.b), near = direction_of(link.a);
        Vec3 apart = own.head<3>() - near.head<3>();
        if (!branches_.empty()) {
            const Vec3 arm = moves_of(from, link.b) - moves_of(from, link.a);
            apart = skeleton::Branches::stretch(arm, apart, (own.tail<3>() + near.tail<3>()) / 2);
        }
        times_too_long = std::max(times_too_long, apart.norm() / (most_parting * link.length));
    }
    return 1 / times_too_long;
}

Eigen::Matrix<double, 6, 1> Solver::direction_of(int sphere) const {
    if (block_of_[sphere] < 0) return Eigen::Matrix<double, 6, 1>::Zero();
    return direction_.segment<6>(6L * block_of_[sphere]);
}

void Solver::move(const double* from, double share, double* to) const {
    for (std::size_t f = 0; f < free_.size(); ++f) {
        const int i = free_[f];
        const auto step = direction_.segment<6>(static_cast<Eigen::Index>(6 * f));
        const Eigen::Quaterniond turned = skeleton::quaternion_of(share * step.tail<3>()) * orientation_of(from, i);
        Eigen::Map<Vec3> x = moves_of(to, i);
        Eigen::Map<Eigen::Vector4d> q(to + row_length * i + 4);
        x = moves_of(from, i) + share * step.head<3>();
        q = turned.coeffs().normalized();
    }
    for (const auto& [sphere, near] : branches_.tree_edges()) {
        const Eigen::Matrix<double, 6, 1> own = direction_of(sphere), inner = direction_of(near);
        const Vec3 arm = moves_of(from, sphere) - moves_of(from, near);
        moves_of(to, sphere) =
            moves_of(to, near) + skeleton::Branches::carried(arm, own.head<3>() - inner.head<3>(),
                                                             (own.tail<3>() + inner.tail<3>()) / 2, share);
    }
}

double Solver::largest(const Vector& v, double of_turns) const {
    double most = 0;
    for (Eigen::Index i = 0; i < v.size(); i += 6) {
        const double size = std::max(v.segment<3>(i).norm(), of_turns * v.segment<3>(i + 3).norm());
        if (!(size <= most)) most = size;  // not a number is the largest
    }
    return most;
}

Solver::Report Solver::solve(const Step& step, const std::vector<ContactState*>& contacts, const double* start,
                             const double* velocity, SphereRows& pose) {
    Report report;
    if (step.h > 0) predict(step, start, velocity, pose.data());
    trial_ = pose;
    bfgs_.forget();
    balance(step, contacts, start, pose.data(), net_);
    bool fresh = false;
    bool due = !step.reuse || !factored_ || factored_h_ != step.h || factored_alpha_ != step.alpha ||
               factored_beta_ != step.beta;
    double shift = 0;
    double last = never, before_last = never;  // corrections, the second by the same factor
    for (; report.iterations < step.iterations; ++report.iterations) {
        report.residual = largest(net_, 1 / length_);
        if (due) {
            if (!factor(step, pose.data(), shift)) return report;
            ++report.factorisations;
        }
        fresh = due;
        due = false;
        correct(contacts, pose.data());
        const double size = largest(direction_, length_);
        if (!std::isfinite(size)) return report;
        if (!fresh && size > slow * before_last) {
            due = true;
            continue;
        }

        // The slope of the potential along the step is to fall by half at least, or go on falling, but not off a cliff.
        const double slope = std::abs(net_.dot(direction_));
        const bool small = size <= tiny * length_;
        double share = 2 * step_limit(pose.data());
        bool falls = false;
        for (int halving = 0; halving < most_halvings && !falls; ++halving) {
            share /= 2;
            move(pose.data(), share, trial_.data());
            balance(step, contacts, start, trial_.data(), there_);
            const double there = there_.dot(direction_);
            falls = small || (there >= -most_slope_left * slope && there <= most_steepening * slope);
        }
        if (!falls) {
            if (fresh) shift = skeleton::larger_shift(shift, stiffest_);
            if (!skeleton::can_shift(shift, stiffest_)) return report;
            due = true;
            continue;
        }
        bfgs_.update(share, direction_, net_, there_);
        pose.swap(trial_);
        trial_ = pose;
        net_.swap(there_);
        // Corrections shrink by size / last: those to come add up to this.
        const bool shrinks = share == 1 && last < never && size < last / 2;
        const double left = shrinks ? size * size / (last - size) : size;
        if (left <= step.tolerance * length_ && shift == 0) {
            report.found = true;
            ++report.iterations;
            report.residual = largest(net_, 1 / length_);
            return report;
        }
        before_last = fresh ? never : last;
        last = size;
        due = !step.reuse || shift > 0;
        shift = skeleton::smaller_shift(shift, stiffest_);
    }
    return report;
}

}  // namespace palpate::runtime
