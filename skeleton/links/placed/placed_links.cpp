#include "skeleton/links/placed/placed_links.h"

#include <algorithm>

#include "skeleton/effects/link_effects.h"
#include "skeleton/links/fibres/uniaxial.h"
#include "skeleton/links/rest_direction.h"
#include "skeleton/links/shear.h"

namespace palpate::skeleton {

namespace {

Vec3 middle(const Link& link, const State& rest) { return 0.5 * (rest.x.row(link.a) + rest.x.row(link.b)).transpose(); }

}  // namespace

PlacedLinks::PlacedLinks(const Model& model, const fem::Effects& effects)
    : order_(model),
      volumes_(model, effects),
      links_(grown_links(model, effects.growth)),
      rest_(rest_state(model)),
      linear_poses_(straight_poses(model, links_)),
      history_(effects),
      torsion_(link_effects(effects).torsion),
      shear_(link_effects(effects).shear),
      plain_(effects.material.empty() && !history_ && torsion_ == 0 && shear_ == 0) {
    directions_.reserve(links_.size());
    for (const Link& link : links_) directions_.push_back(rest_direction(model, link));
    if (plain_) return;
    std::ranges::copy_if(effects.material, std::back_inserter(material_),
                         [](const auto& effect) { return !effect->is_scale(); });
    laws_ = section_laws(model, effects);
    for (const auto& effect : material_) in_sections_.push_back(acts_in_sections(*effect, Vec3(rest_.x.row(0))));
    const bool has_fibres = !material_.empty() || history_;
    if (has_fibres) lengths_ = fibre_lengths(model, links_);
    for (size_t l = 0; l < links_.size(); ++l) {
        const FibreOffsets offsets = fibre_offsets(links_[l], directions_[l]);
        scales_.push_back(scale_of(links_[l], offsets, effects));
        if (!has_fibres) continue;
        offsets_.push_back(offsets);
        shares_.push_back(fibre_shares(links_[l]));
    }
}

double PlacedLinks::scale_of(const Link& link, const FibreOffsets& offsets, const fem::Effects& effects) const {
    const Vec3 X_a = rest_.x.row(link.a).transpose(), X_b = rest_.x.row(link.b).transpose();
    constexpr int slices = 8;
    double softness = 0;
    for (int i = 0; i < slices; ++i) {
        const Vec3 X = X_a + (i + 0.5) / slices * (X_b - X_a);
        double of_slice = 0;
        for (int j = 0; j < fibres_per_link; ++j) {
            double scale = 1;
            for (const auto& effect : effects.material) scale *= effect->stiffness(X + offsets[j]);
            of_slice += fibre_weight * scale;
        }
        softness += 1 / (of_slice * slices);
    }
    return 1 / softness;
}

LinkFibre PlacedLinks::fibre(size_t link, int j, const LinkPose& ends) const {
    return {lengths_[link][j], offsets_[link][j], ends.x_a, ends.R_a, ends.x_b, ends.R_b};
}

// L^2 (w / 3 + p) of one fibre: its energy at unit stiffness.
StretchTerms PlacedLinks::fibre_terms(size_t link, int j, double stretch, bool with_second,
                                      const FibreStates& before) const {
    StretchTerms sum;
    for (std::size_t e = 0; e < material_.size(); ++e) {
        if (has_law(link) && in_sections_[e]) continue;
        const Vec3 X = middle(links_[link], rest_);
        sum += (1.0 / 3) * uniaxial(*material_[e], X, directions_[link], stretch, with_second);
    }
    if (history_) {
        const FibreState had = before.empty() ? FibreState() : before[fibres_per_link * link + j];
        sum += history_terms(history_, had, stretch);
    }
    return links_[link].length * links_[link].length * sum;
}

Link PlacedLinks::straight(size_t l) const {
    Link link = links_[l];
    if (link.section) link.section->natural.setZero();
    return link;
}

FullLink PlacedLinks::coupled(const Link& link, size_t l, const LinkPose& ends) const {
    FullLink now = full_link(link, rest_, ends);
    if (has_law(l)) now.couple(laws_[l].coupling);
    return now;
}

void PlacedLinks::add_effects(size_t l, const LinkPose& ends, const FibreStates& before, bool with_hessian,
                              LinkTerms& terms) const {
    const Link& link = links_[l];
    if (has_law(l)) {
        for (int s = 0; s < 6; ++s) {
            const double factor = laws_[l].factors[s] / scales_[l];
            terms.energy[s] *= factor;
            terms.gradient.col(s) *= factor;
            if (with_hessian) terms.hessian[s] *= factor;
        }
    }
    if (torsion_ != 0) {
        terms.energy[1] += torsion_ * terms.energy[2];
        terms.gradient.col(1) += torsion_ * terms.gradient.col(2);
        if (with_hessian) terms.hessian[1] += torsion_ * terms.hessian[2];
    }
    if (shear_ != 0) {
        const Shear shear(link.length, directions_[l], ends.x_a, ends.R_a, ends.x_b, ends.R_b);
        terms.energy[0] += shear_ * shear.energy();
        shear.add_gradient(shear_, terms.gradient.col(0));
        if (with_hessian) shear.add_hessian(shear_, terms.hessian[0]);
    }
    if (!offsets_.empty())
        for (int j = 0; j < fibres_per_link; ++j) {
            const LinkFibre one = fibre(l, j, ends);
            const StretchTerms its = fibre_terms(l, j, one.stretch(), with_hessian, before);
            Vec12 gradient = Vec12::Zero();
            Mat12 hessian = Mat12::Zero();
            one.add_gradient(its, gradient);
            if (with_hessian) one.add_hessian(its, hessian);
            for (Eigen::Index s = 0; s < terms.energy.size(); ++s) {
                const double share = shares_[l](j, s);
                if (share == 0) continue;
                terms.energy[s] += share * its.energy;
                terms.gradient.col(s) += share * gradient;
                if (with_hessian) terms.hessian[s] += share * hessian;
            }
        }
    terms.energy *= scales_[l];
    terms.gradient *= scales_[l];
    if (with_hessian)
        for (Eigen::Index s = 0; s < terms.energy.size(); ++s) terms.hessian[s] *= scales_[l];
}

LinkTerms PlacedLinks::terms(size_t l, const LinkPose& ends, bool with_hessian, const FibreStates& before) const {
    return terms_of(links_[l], l, ends, with_hessian, before);
}

LinkTerms PlacedLinks::linear_terms(size_t l, const FibreStates& before) const {
    return terms_of(straight(l), l, linear_poses_[l], true, before);
}

Mat12 PlacedLinks::hessian(size_t l, const Stiffnesses& k, const LinkPose& ends, const FibreStates& before) const {
    return hessian_of(links_[l], l, k, ends, before);
}

Mat12 PlacedLinks::linear_hessian(size_t l, const Stiffnesses& k, const FibreStates& before) const {
    return hessian_of(straight(l), l, k, linear_poses_[l], before);
}

LinkTerms PlacedLinks::terms_of(const Link& link, size_t l, const LinkPose& ends, bool with_hessian,
                                const FibreStates& before) const {
    LinkTerms terms =
        link.section ? full_link_terms(coupled(link, l, ends), with_hessian)
                     : link_terms(link.length, directions_[l], ends.x_a, ends.R_a, ends.x_b, ends.R_b, with_hessian);
    if (!plain_) add_effects(l, ends, before, with_hessian, terms);
    return terms;
}

Mat12 PlacedLinks::hessian_of(const Link& link, size_t l, const Stiffnesses& k, const LinkPose& ends,
                              const FibreStates& before) const {
    Stiffnesses with_torsion = k;
    if (!plain_) with_torsion[2] += torsion_ * k[1];
    if (has_law(l)) with_torsion = with_torsion.cwiseProduct(laws_[l].factors) / scales_[l];
    Mat12 H = Mat12::Zero();
    if (link.section)
        coupled(link, l, ends).add_hessian(with_torsion, H);
    else
        H = link_hessian(with_torsion, link.length, directions_[l], ends.x_a, ends.R_a, ends.x_b, ends.R_b);
    if (plain_) return H;
    if (shear_ != 0)
        Shear(link.length, directions_[l], ends.x_a, ends.R_a, ends.x_b, ends.R_b).add_hessian(shear_ * k[0], H);
    if (!offsets_.empty())
        for (int j = 0; j < fibres_per_link; ++j) {
            const LinkFibre one = fibre(l, j, ends);
            one.add_hessian(shares_[l].row(j).dot(k) * fibre_terms(l, j, one.stretch(), true, before), H);
        }
    return scales_[l] * H;
}

template <typename ForcesOf>
Eigen::SparseMatrix<double> PlacedLinks::assembled(const ForcesOf& forces_of,
                                                   std::vector<Eigen::Triplet<double>> of_volumes) const {
    std::vector<Eigen::Triplet<double>>& entries = of_volumes;
    entries.reserve(entries.size() + 12 * static_cast<std::size_t>(order_.per_link()) * links_.size());
    for (size_t l = 0; l < links_.size(); ++l) {
        const auto forces = forces_of(l);
        for (int s = 0; s < order_.per_link(); ++s)
            for (int i = 0; i < 12; ++i)
                entries.emplace_back(i < 6 ? 6 * links_[l].a + i : 6 * links_[l].b + i - 6,
                                     static_cast<int>(order_.of_link(static_cast<Eigen::Index>(l), s)), forces(i, s));
    }
    Eigen::SparseMatrix<double> G(6 * rest_.x.rows(), order_.size());
    G.setFromTriplets(entries.begin(), entries.end());
    return G;
}

Eigen::SparseMatrix<double> PlacedLinks::forces(const State& state, const FibreStates& before) const {
    std::vector<Eigen::Triplet<double>> of_volumes;
    volumes_.add_forces(state, of_volumes);
    return assembled([&](size_t l) { return (-terms(l, state, false, before).gradient).eval(); },
                     std::move(of_volumes));
}

// The force of a link at unit stiffness s is -(gradient + Hessian * step), the gradient at rest.
Eigen::SparseMatrix<double> PlacedLinks::linear_forces(const Eigen::VectorXd& step, const FibreStates& before) const {
    std::vector<Eigen::Triplet<double>> of_volumes;
    volumes_.add_linear_forces(step, of_volumes);
    return assembled(
        [&](size_t l) {
            const LinkTerms at_rest = terms(l, rest_, false, before), linear = linear_terms(l, before);
            Vec12 own;
            own << step.segment<6>(Eigen::Index{6} * links_[l].a), step.segment<6>(Eigen::Index{6} * links_[l].b);
            Eigen::Matrix<double, 12, Eigen::Dynamic, 0, 12, 6> forces = -at_rest.gradient;
            for (int s = 0; s < order_.per_link(); ++s) forces.col(s) -= linear.hessian[s] * own;
            return forces;
        },
        std::move(of_volumes));
}

Stiffnesses PlacedLinks::rest_stiffness(size_t l, const Stiffnesses& k) const {
    if (plain_) return k;
    // Fibres stiffen tension and bending alike.
    double stiffer = 1;
    if (!material_.empty()) {
        const StretchTerms on_axis = fibre_terms(l, 0, fibre(l, 0, pose(links_[l], rest_)).stretch(), true, {});
        stiffer += std::max(0.0, on_axis.second / (links_[l].length * links_[l].length));
    }
    Stiffnesses own = k;
    own[2] += torsion_ * k[1];
    if (has_law(l)) own = own.cwiseProduct(laws_[l].factors) / scales_[l];
    own.head<2>() << stiffer * own[0] + shear_ * k[0], stiffer * own[1];
    return scales_[l] * own;
}

double PlacedLinks::largest_rest_force(const Eigen::VectorXd& k, const FibreStates& before) const {
    double most = 0;
    if (offsets_.empty()) return most;
    for (size_t l = 0; l < links_.size(); ++l)
        for (int j = 0; j < fibres_per_link; ++j) {
            const StretchTerms its = fibre_terms(l, j, fibre(l, j, pose(links_[l], rest_)).stretch(), false, before);
            const double force = std::abs(its.first) / links_[l].length;
            most = std::max(most, scales_[l] * k[3 * static_cast<Eigen::Index>(l)] * force);
        }
    return most;
}

}  // namespace palpate::skeleton
