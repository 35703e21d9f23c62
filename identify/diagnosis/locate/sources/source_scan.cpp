#include "identify/diagnosis/locate/sources/source_scan.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "identify/diagnosis/locate/sources/source_laws.h"
#include "mesh/core/surface.h"

namespace palpate::identify {
namespace {

/// Those of unit vectors that lead out of the body where `inward` leads into it; all where that is 0 (n x 3).
Points out_of_body(const Points& directions, const Vec3& inward) {
    if (inward.isZero()) return directions;
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index d = 0; d < directions.rows(); ++d)
        if (directions.row(d).dot(inward) < 0) chosen.push_back(d);
    return directions(chosen, Eigen::all);
}

/// Is a place so small that its parts move about alike: at most twice as large as the smallest? What a part of the body
/// meets the rest of a larger place may not.
bool moves_as_one(const SourceBasis& basis, std::size_t place) {
    constexpr double twice = 2.01;
    return basis.places[place].radius < twice * basis.places.front().radius;
}

}  // namespace

SourceScan::SourceScan(const BodyModel& model, const Problem& problem, const Refit& fit, int threads)
    : problem_(problem),
      entries_(reading_entries(problem)),
      bases_(source_bases(model, problem, fit, entries_, threads)),
      V_(with_numbers_unknown(fit)),
      score_(V_, fit.error, read_states(problem)) {}

std::vector<Alternative> SourceScan::alternatives() {
    const Eigen::VectorXd everywhere = Eigen::VectorXd::Ones(std::ssize(problem_.stages));
    const auto laws = common_laws(problem_);
    const auto probes = probes_alone(problem_);
    for (const SourceBasis& basis : bases_) {
        if (basis.places.empty()) continue;
        if (basis.law) {
            add(basis, *basis.law, everywhere, 0);
            continue;
        }
        // What differs from state to state by no law of load, time or motion touches from outside, or is the
        // camera's.
        const bool alone = basis.form == SourceForm::traction || basis.form == SourceForm::frame;
        const bool may_be_met = basis.motions.size() > 0;
        constexpr std::size_t of_single_states = 3;  // in one probe, in some states, irregular
        const double share =
            -std::log(static_cast<double>(laws.size() + (alone ? of_single_states : 0) + (may_be_met ? 1 : 0)));
        // A set says what touches the body: that something does in all states, though none says so, is less likely
        // than a force that needs no touch, which it cannot be told from where the body is slender.
        constexpr double unsaid = -2.3;  // ln of a tenth: a prior, design choice
        for (const auto& [law, strength] : laws) {
            const bool touches = basis.kind == SourceKind::boundary && law == SourceLaw::constant;
            add(basis, law, strength, share + (touches ? unsaid : 0));
        }
        if (!alone) continue;
        for (const auto& [probe, strength] : probes)
            add(basis, SourceLaw::one_probe, strength, share - std::log(static_cast<double>(probes.size())), probe);
        add_irregular(basis, share);
        if (!may_be_met) continue;
        const Points directions = mesh::make_sphere(Vec3::Zero(), 1, 1).vertices;  // 35 degrees apart
        for (std::size_t place = 0; place < basis.places.size(); ++place) {
            if (moves_as_one(basis, place))
                add_one_sided(basis, place, out_of_body(directions, basis.places[place].axis), share);
        }
    }
    return std::move(found_);
}

Eigen::VectorXd SourceScan::altered(const Alternative& one) const {
    return rows_of(*one.basis, one.term.strength, static_cast<Eigen::Index>(one.place), 1) * one.term.mean;
}

/// Columns of some of a basis' places, under strengths of each state (N x places p).
Eigen::MatrixXd SourceScan::rows_of(const SourceBasis& basis, const Eigen::VectorXd& strength, Eigen::Index place,
                                    Eigen::Index places) const {
    const Eigen::Index p = basis.width;
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(problem_.rows(), places * p);
    for (std::size_t e = 0; e < entries_.size(); ++e) {
        const double weight = entries_[e].sign * strength[entries_[e].state];
        if (weight != 0)
            result.row(entries_[e].row) +=
                weight * basis.columns.row(static_cast<Eigen::Index>(e)).segment(place * p, places * p);
    }
    return result;
}

void SourceScan::add(const SourceBasis& basis, SourceLaw law, const Eigen::VectorXd& strength, double log_prior,
                     int probe) {
    const auto places = std::ssize(basis.places);
    const std::vector<SourceEvidence> all = score_(rows_of(basis, strength, 0, places), basis.width, basis.one_sided);
    for (std::size_t i = 0; i < all.size(); ++i) keep(basis, i, all[i], law, strength, log_prior, 0, probe);
}

void SourceScan::keep(const SourceBasis& basis, std::size_t place, const SourceEvidence& found, SourceLaw law,
                      const Eigen::VectorXd& strength, double log_prior, double gap, int probe) {
    if (!std::isfinite(found.log_bayes_factor)) return;
    const SourcePlace& at = basis.places[place];
    Alternative one{.kind = basis.kind, .basis = &basis, .place = place};
    one.term = {.form = basis.form,
                .law = law,
                .centre = at.centre,
                .radius = at.radius,
                .extent = at.extent,
                .norm = at.norm,
                .axis = at.axis,
                .gap = gap,
                .number = probe >= 0 ? probe : at.number,
                .log_bayes_factor = found.log_bayes_factor,
                .mean = found.mean,
                .sd = found.covariance.diagonal().cwiseSqrt(),
                .covariance = found.covariance,
                .strength = strength};
    one.explained = found.explained;
    one.log_weight = found.log_bayes_factor + at.log_prior + log_prior;
    one.log_fit = found.log_fit + at.log_prior;
    found_.push_back(std::move(one));
}

/// Something in the way of the skin, without friction: it pushes back against the direction in which a place moves
/// towards it, in proportion to how far that goes beyond a gap, which no law of the load is.
void SourceScan::add_one_sided(const SourceBasis& basis, std::size_t place, const Points& towards, double log_prior) {
    // At how much of the largest motion it is met; design choice: between two of them evidence is as of the nearest.
    constexpr std::array<double, 4> gaps{0, 0.25, 0.5, 0.75};
    log_prior -= std::log(static_cast<double>(gaps.size()) * static_cast<double>(towards.rows()));
    const auto first = static_cast<Eigen::Index>(3 * place);
    const Eigen::MatrixXd moved = basis.motions.middleCols<3>(first) * towards.transpose();  // (actions x directions)
    const Eigen::MatrixXd felt = -basis.columns.middleCols<3>(first) * towards.transpose();  // (entries x directions)
    Eigen::MatrixXd strengths = Eigen::MatrixXd::Zero(std::ssize(problem_.stages), towards.rows() * std::ssize(gaps));
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(problem_.rows(), strengths.cols());
    const auto gap_of = [&](Eigen::Index c) { return gaps[static_cast<std::size_t>(c / towards.rows())]; };
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
        const Eigen::Index d = c % towards.rows();
        const double most = moved.col(d).maxCoeff();
        if (!(most > 0)) continue;
        for (std::size_t e = 0; e < entries_.size(); ++e) {
            const ReadingEntry& entry = entries_[e];
            const double strength = std::max(0.0, (moved(entry.action, d) / most - gap_of(c)) / (1 - gap_of(c)));
            strengths(entry.state, c) = strength;
            columns(entry.row, c) += entry.sign * strength * felt(static_cast<Eigen::Index>(e), d);
        }
    }
    std::vector<SourceEvidence> all = score_(columns, 1, true);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
        const Vec3 toward = towards.row(c % towards.rows()).transpose();
        SourceEvidence& one = all[static_cast<std::size_t>(c)];
        one.covariance = one.covariance(0, 0) * toward * toward.transpose();
        one.mean = -one.mean[0] * toward;
        const double gap = gap_of(c) * moved.col(c % towards.rows()).maxCoeff();
        keep(basis, place, one, SourceLaw::one_sided, strengths.col(c), log_prior, gap);
    }
}

/// A vector of its own in each action, at the place that the laws found likeliest; as if only that place could have
/// it. Told along the direction that they share most. Then one vector for those actions where it is largest.
void SourceScan::add_irregular(const SourceBasis& basis, double log_prior) {
    const Alternative* best = nullptr;
    for (const Alternative& one : found_)
        if (one.basis == &basis && (!best || one.log_weight > best->log_weight)) best = &one;
    if (!best || basis.width != 3) return;
    std::vector<int> actions;
    for (const ReadingEntry& entry : entries_)
        if (actions.empty() || actions.back() != entry.action) actions.push_back(entry.action);
    const auto count = std::ssize(actions);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(problem_.rows(), 3 * count);
    const auto first = static_cast<Eigen::Index>(3 * best->place);
    Eigen::Index k = -1;
    int last = -1;
    for (std::size_t e = 0; e < entries_.size(); ++e) {
        if (entries_[e].action != last) ++k;
        last = entries_[e].action;
        columns.row(entries_[e].row).segment<3>(3 * k) +=
            entries_[e].sign * basis.columns.row(static_cast<Eigen::Index>(e)).segment<3>(first);
    }
    const SourceEvidence all = score_(columns, static_cast<int>(3 * count)).front();
    if (!std::isfinite(all.log_bayes_factor)) return;

    const Eigen::Map<const Eigen::MatrixXd> vectors(all.mean.data(), 3, count);
    Vec3 direction = Eigen::SelfAdjointEigenSolver<Mat3>(vectors * vectors.transpose()).eigenvectors().col(2);
    Eigen::VectorXd along = vectors.transpose() * direction;
    Eigen::Index most = 0;
    const double magnitude = along.cwiseAbs().maxCoeff(&most);
    if (!(magnitude > 0)) return;
    const double size = along[most];  // with its sign
    Alternative one = *best;
    one.term.law = SourceLaw::irregular;
    one.term.number = -1;
    one.term.log_bayes_factor = all.log_bayes_factor;
    one.term.mean = size * direction;
    one.term.covariance = all.covariance.block<3, 3>(3 * most, 3 * most);
    one.term.sd = one.term.covariance.diagonal().cwiseSqrt();
    one.term.strength = in_states(actions, along / size);
    one.explained = all.explained;
    one.log_weight = all.log_bayes_factor + log_prior - std::log(static_cast<double>(basis.places.size()));
    const auto place = static_cast<Eigen::Index>(best->place);
    found_.push_back(std::move(one));
    add_some_states(basis, place, actions, along / size, log_prior);
}

/// One vector, alike in some actions and absent in the others: those where it is largest, as many as are likeliest
/// at this place. A priori every number of them is as likely as another, and so is every choice of so many.
void SourceScan::add_some_states(const SourceBasis& basis, Eigen::Index place, const std::vector<int>& actions,
                                 const Eigen::VectorXd& along, double log_prior) {
    const auto count = std::ssize(actions);
    std::vector<Eigen::Index> largest(count);
    std::iota(largest.begin(), largest.end(), 0);
    std::ranges::stable_sort(largest, std::greater{}, [&](Eigen::Index k) { return along[k]; });
    Eigen::VectorXd chosen = Eigen::VectorXd::Zero(count), best;
    double most = -INFINITY, prior_of_best = 0;
    double log_choices = 0;  // ln of how many choices of so many actions there are
    for (Eigen::Index taken = 1; taken < count; ++taken) {
        chosen[largest[taken - 1]] = 1;
        log_choices += std::log(static_cast<double>(count - taken + 1) / static_cast<double>(taken));
        if (taken == 1) continue;  // a probe alone, or part of it
        const double prior = log_prior - std::log(static_cast<double>(count)) - log_choices;
        const SourceEvidence found =
            score_(rows_of(basis, in_states(actions, chosen), place, 1), basis.width, basis.one_sided).front();
        if (!(found.log_bayes_factor + prior > most)) continue;
        most = found.log_bayes_factor + prior;
        prior_of_best = prior;
        best = chosen;
    }
    if (best.size() > 0) add(basis, SourceLaw::some_states, in_states(actions, best), prior_of_best);
}

/// Of each state (S) what is given of its action; 0 where nothing is read.
Eigen::VectorXd SourceScan::in_states(const std::vector<int>& actions, const Eigen::VectorXd& of_actions) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(std::ssize(problem_.stages));
    for (const ReadingEntry& entry : entries_)
        result[entry.state] = of_actions[std::ranges::lower_bound(actions, entry.action) - actions.begin()];
    return result;
}

}  // namespace palpate::identify
