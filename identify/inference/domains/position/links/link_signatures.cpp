#include "identify/inference/domains/position/links/link_signatures.h"

#include <Eigen/Eigenvalues>

namespace palpate::identify {
namespace {

using skeleton::Mat12, skeleton::Vec12;

struct Term {
    Vec12 f;
    double weight;
};

/// A symmetric matrix as sum of weight f f^T: Cholesky's columns from the largest diagonal on, as long as they are
/// worth it; eigenvectors where the diagonal tells too little of what is left.
std::vector<Term> terms_of(Mat12 H) {
    constexpr double rounding = 1e-14;  // of the largest entry: some fifty times that of doubles
    constexpr double enough = 1e-2;     // of the largest entry: a smaller pivot would magnify rounding as much
    std::vector<Term> terms;
    const double negligible = rounding * H.cwiseAbs().maxCoeff();
    for (double left = H.cwiseAbs().maxCoeff(); left > negligible; left = H.cwiseAbs().maxCoeff()) {
        Eigen::Index p = 0;
        if (H.diagonal().cwiseAbs().maxCoeff(&p) < enough * left) {
            const Eigen::SelfAdjointEigenSolver<Mat12> eigen(H);
            for (int i = 0; i < 12; ++i) terms.push_back({eigen.eigenvectors().col(i), eigen.eigenvalues()[i]});
            return terms;
        }
        const Term term{H.col(p), 1 / H(p, p)};
        H -= term.weight * term.f * term.f.transpose();
        H.row(p).setZero();
        H.col(p).setZero();
        terms.push_back(term);
    }
    return terms;
}

}  // namespace

LinksAtRest::LinksAtRest(const skeleton::Model& model)
    : placed(model, skeleton::physics_of(model.effects)), state(skeleton::rest_state(model)), order(model), first{0} {
    const Eigen::Index n = order.per_link(), L = std::ssize(model.links);
    const bool linear = model.law == skeleton::EquilibriumLaw::linear;
    gradients.resize(12, n * L);
    std::vector<Term> found;
    for (Eigen::Index l = 0; l < L; ++l) {
        ends.push_back({model.links[l].a, model.links[l].b});
        const auto link = static_cast<std::size_t>(l);
        gradients.middleCols(n * l, n) = placed.terms(link, state, false).gradient;
        if (linear) {
            const skeleton::LinkTerms terms = placed.linear_terms(link);
            for (int s = 0; s < n; ++s) {
                for (const Term& term : terms_of(terms.hessian[s])) {
                    found.push_back(term);
                    kind.push_back(s);
                }
            }
        }
        first.push_back(std::ssize(found));
    }
    strains.resize(12, std::ssize(found));
    weights.resize(std::ssize(found));
    for (Eigen::Index j = 0; j < weights.size(); ++j) {
        strains.col(j) = found[j].f;
        weights[j] = found[j].weight;
    }
}

LinkSignatures::LinkSignatures(std::shared_ptr<const LinksAtRest> links, const skeleton::Equilibrium& at,
                               skeleton::EquilibriumLaw law)
    : links_(std::move(links)), of_links_(-links_->gradients) {
    const LinksAtRest& rest = *links_;
    const Eigen::Index n = rest.order.per_link();
    std::vector<Eigen::Triplet<double>> entries;
    if (law == skeleton::EquilibriumLaw::linear) {
        // -(gradient + Hessian * step)
        for (Eigen::Index l = 0; l < std::ssize(rest.ends); ++l) {
            Vec12 own;
            own << at.step.segment<6>(Eigen::Index{6} * rest.ends[l][0]),
                at.step.segment<6>(Eigen::Index{6} * rest.ends[l][1]);
            for (Eigen::Index j = rest.first[l]; j < rest.first[l + 1]; ++j) {
                of_links_.col(n * l + rest.kind[j]) -=
                    rest.weights[j] * rest.strains.col(j).dot(own) * rest.strains.col(j);
            }
        }
        rest.placed.volumes().add_linear_forces(at.step, entries);
    } else {
        for (Eigen::Index l = 0; l < std::ssize(rest.ends); ++l) {
            of_links_.middleCols(n * l, n) =
                -rest.placed.terms(static_cast<std::size_t>(l), at.state, false, at.before).gradient;
        }
        rest.placed.volumes().add_forces(at.state, entries);
    }
    of_volumes_.resize(Eigen::Index{6} * rest.state.x.rows(), rest.order.size());
    of_volumes_.setFromTriplets(entries.begin(), entries.end());
}

fem::MultiVector LinkSignatures::times(const fem::MultiVector& K) const {
    fem::MultiVector F = of_volumes_ * K;
    const Eigen::Index n = links_->order.per_link();
    fem::MultiVector own(n, K.cols()), pulls(12, K.cols());
    for (Eigen::Index l = 0; l < std::ssize(links_->ends); ++l) {
        for (int s = 0; s < n; ++s) own.row(s) = K.row(links_->order.of_link(l, s));
        pulls.noalias() = of_links_.middleCols(n * l, n).lazyProduct(own);
        F.middleRows<6>(Eigen::Index{6} * links_->ends[l][0]) += pulls.topRows<6>();
        F.middleRows<6>(Eigen::Index{6} * links_->ends[l][1]) += pulls.bottomRows<6>();
    }
    return F;
}

fem::MultiVector LinkSignatures::transposed_times(const fem::MultiVector& F) const {
    fem::MultiVector K = of_volumes_.transpose() * F;
    const Eigen::Index n = links_->order.per_link();
    fem::MultiVector ends(12, F.cols()), own(n, F.cols());
    for (Eigen::Index l = 0; l < std::ssize(links_->ends); ++l) {
        ends.topRows<6>() = F.middleRows<6>(Eigen::Index{6} * links_->ends[l][0]);
        ends.bottomRows<6>() = F.middleRows<6>(Eigen::Index{6} * links_->ends[l][1]);
        own.noalias() = of_links_.middleCols(n * l, n).transpose().lazyProduct(ends);
        for (int s = 0; s < n; ++s) K.row(links_->order.of_link(l, s)) = own.row(s);
    }
    return K;
}

}  // namespace palpate::identify
