#include "identify/preflight/prospects/evidence_of_signatures.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

constexpr int most_cases = 40;                     // medians of least strengths are then known to some 15 %
constexpr double weakest = 1e-4, strongest = 1e4;  // factors that are looked at: eight decades about the prior

/// ln of the mean of exp(a^2 growth - occam).
double evidence(const Eigen::VectorXd& growth, const Eigen::VectorXd& occam, double a) {
    const Eigen::ArrayXd each = a * a * growth.array() - occam.array();
    const double most = each.maxCoeff();
    if (!std::isfinite(most)) return -INFINITY;
    return most + std::log((each - most).exp().mean());
}

/// The least factor for which a condition holds that stays fulfilled once it is, to a hundredth; infinite: none.
template <typename Condition>
double least_that(const Condition& holds) {
    if (!holds(strongest)) return INFINITY;
    double low = std::log(weakest), high = std::log(strongest);
    while (high - low > 0.01) {
        const double middle = 0.5 * (low + high);
        (holds(std::exp(middle)) ? high : low) = middle;
    }
    return std::exp(high);
}

}  // namespace

EffectCases draw_cases(const EffectSignature& signature) {
    const ScreenColumns& columns = signature.columns;
    const Eigen::Index p = columns.prior_sd.size(), alternatives = columns.alternatives();
    // Without places or directions there are two cases, or one.
    const bool is_single = p == 1 && alternatives == 1;
    const int count = !is_single ? most_cases : columns.one_sided ? 1 : 2;
    EffectCases cases{Eigen::MatrixXd(columns.columns.rows(), count), Eigen::MatrixXd(p, count), {}};
    std::vector<double> sizes;
    for (int c = 0; c < count; ++c) {
        RandomStream random(1, 0, static_cast<std::uint64_t>(c));
        // Alternatives are taken in turn at even steps, so that they are spread as they are listed.
        const Eigen::Index i = is_single ? 0 : (2 * c + 1) * alternatives / (2 * count);
        Eigen::VectorXd z = random.normals(static_cast<int>(p)).normalized() * std::sqrt(static_cast<double>(p));
        if (is_single) z[0] = c == 0 ? 1 : -1;
        if (columns.one_sided) z = z.cwiseAbs();
        cases.values.col(c) = z.cwiseProduct(columns.prior_sd);
        cases.readings.col(c) = columns.columns.middleCols(i * p, p) * cases.values.col(c);
        cases.alternative.push_back(i);
        sizes.push_back(cases.readings.col(c).norm());
    }
    const double largest = sizes.empty() ? 0 : *std::ranges::max_element(sizes);
    constexpr double nothing = 1e-9;  // next to the largest: rounding
    std::vector<Eigen::Index> kept, alternative;
    for (int c = 0; c < count; ++c) {
        if (!(sizes[c] > nothing * largest)) continue;
        kept.push_back(c);
        alternative.push_back(cases.alternative[c]);
    }
    return {cases.readings(Eigen::all, kept), cases.values(Eigen::all, kept), alternative};
}

EvidenceOfSignatures::EvidenceOfSignatures(const Whitening& V, const std::vector<EffectSignature>& signatures) : V_(V) {
    for (const EffectSignature& signature : signatures) {
        const ScreenColumns& columns = signature.columns;
        Whitened effect{.over_prior = {}, .inverse_factor = {}, .occam = {}};
        effect.p = columns.prior_sd.size();
        effect.one_sided = columns.one_sided;
        const Eigen::Index alternatives = columns.alternatives();
        if (alternatives > 0) {
            const Eigen::MatrixXd B = columns.columns * columns.prior_sd.replicate(alternatives, 1).asDiagonal();
            effect.over_prior = V.apply(B);
            effect.occam.resize(alternatives);
            effect.inverse_factor.reserve(static_cast<std::size_t>(alternatives));
            const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(effect.p, effect.p);
            for (Eigen::Index i = 0; i < alternatives; ++i) {
                const auto own = B.middleCols(i * effect.p, effect.p);
                const Eigen::MatrixXd M = own.transpose() * effect.over_prior.middleCols(i * effect.p, effect.p);
                const Eigen::LLT<Eigen::MatrixXd> factor(one + 0.5 * (M + M.transpose()));
                effect.inverse_factor.push_back(factor.matrixL().solve(one));
                effect.occam[i] = factor.matrixLLT().diagonal().array().log().sum();
            }
            if (effect.one_sided) effect.occam.array() -= std::numbers::ln2;
        }
        effects_.push_back(std::move(effect));
    }
}

Eigen::MatrixXd EvidenceOfSignatures::growth(const Whitened& effect, const Eigen::MatrixXd& readings) {
    const Eigen::Index alternatives = effect.occam.size();
    if (alternatives == 0) return Eigen::MatrixXd(0, readings.cols());  // it cannot show here
    const Eigen::MatrixXd s = effect.over_prior.transpose() * readings;
    Eigen::MatrixXd result(alternatives, readings.cols());
    for (Eigen::Index i = 0; i < alternatives; ++i) {
        const Eigen::MatrixXd own =
            effect.inverse_factor[static_cast<std::size_t>(i)] * s.middleRows(i * effect.p, effect.p);
        result.row(i) = 0.5 * own.colwise().squaredNorm();
        if (!effect.one_sided) continue;
        // x = (1 + M)^-1 s = L^-T L^-1 s
        const Eigen::RowVectorXd sum =
            (effect.inverse_factor[static_cast<std::size_t>(i)].transpose() * own).colwise().sum();
        for (Eigen::Index c = 0; c < sum.size(); ++c) {
            if (!(sum[c] > 0)) result(i, c) = -INFINITY;
        }
    }
    return result;
}

EvidenceOfSignatures::LeastFactors EvidenceOfSignatures::least_factors(std::size_t own, const EffectCases& cases,
                                                                       const NamingRules& rules) const {
    const auto N = static_cast<double>(cases.readings.rows());
    const Eigen::VectorXd chi_square = cases.readings.cwiseProduct(V_.apply(cases.readings)).colwise().sum();
    std::vector<Eigen::MatrixXd> grown;
    grown.reserve(effects_.size());
    for (const Whitened& effect : effects_) grown.push_back(growth(effect, cases.readings));

    LeastFactors result;
    for (Eigen::Index c = 0; c < cases.readings.cols(); ++c) {
        const auto evidence_of = [&](std::size_t e, double a) {
            return grown[e].rows() == 0 ? -INFINITY : evidence(grown[e].col(c), effects_[e].occam, a);
        };
        const double seen = least_that([&](double a) {
            const double ours = evidence_of(own, a);
            const bool passes_for_noise = 1 + a * a * chi_square[c] / N <= rules.most_left * rules.most_left;
            return ours >= (passes_for_noise ? rules.least_next_to_noise : rules.least_evidence);
        });
        double named = seen;
        int rival = -1;
        for (std::size_t other = 0; other < effects_.size() && std::isfinite(named); ++other) {
            if (other == own) continue;
            const double leads = least_that([&](double a) {
                return evidence_of(own, a) - std::max(evidence_of(other, a), 0.0) >= rules.least_lead;
            });
            if (leads <= named) continue;
            named = leads;
            rival = static_cast<int>(other);
        }
        result.seen.push_back(seen);
        result.named.push_back(named);
        result.rival.push_back(rival);
    }
    return result;
}

}  // namespace palpate::identify
