#include "skeleton/runtime/forces/fibres.h"

#include <algorithm>

#include "skeleton/effects/link_effects.h"
#include "skeleton/links/fibres/uniaxial.h"
#include "skeleton/links/shear.h"
#include "skeleton/runtime/kernels/tables.h"
#include "skeleton/statics/statics.h"

namespace palpate::runtime {

Fibres::Fibres(const skeleton::Model& model, const fem::Effects& effects,
               const std::vector<skeleton::FibreLengths>& lengths, const std::vector<skeleton::Stiffnesses>& k,
               const std::vector<skeleton::SectionLaw>& laws)
    : history_(effects) {
    std::ranges::copy_if(effects.material, std::back_inserter(material_),
                         [](const auto& effect) { return !effect->is_scale(); });
    for (const auto& effect : material_)
        in_sections_.push_back(skeleton::acts_in_sections(*effect, model.spheres.front().center));
    const double shear = skeleton::link_effects(effects).shear;
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const skeleton::Link& link = model.links[l];
        OfLink own;
        own.a = link.a;
        own.b = link.b;
        own.length = link.length;
        own.shear = shear * k[l][0];
        own.by_law = !laws.empty() && laws[l].in_force;
        own.direction = skeleton::rest_direction(model, link);
        own.middle = 0.5 * (model.spheres[link.a].center + model.spheres[link.b].center);
        own.offsets = skeleton::fibre_offsets(link, own.direction);
        own.lengths = lengths[l];
        own.strengths = skeleton::fibre_shares(link) * k[l];
        links_.push_back(own);
    }
    if (history_) borne_.resize(skeleton::fibres_per_link * links_.size());
}

bool Fibres::needed(const skeleton::Model& model, const fem::Effects& effects,
                    const std::vector<skeleton::SectionLaw>& laws) {
    const bool all_by_law = !laws.empty() && !std::ranges::any_of(laws, [](const auto& law) { return !law.in_force; });
    return skeleton::link_effects(effects).shear != 0 || effects.remember() ||
           std::ranges::any_of(effects.material, [&](const auto& effect) {
               return !effect->is_scale() &&
                      !(all_by_law && skeleton::acts_in_sections(*effect, model.spheres.front().center));
           });
}

skeleton::LinkFibre Fibres::fibre(const OfLink& link, int j, const Poses& poses) const {
    return {link.lengths[j], link.offsets[j], poses.x[link.a], poses.R[link.a], poses.x[link.b], poses.R[link.b]};
}

// K L^2 (w / 3 + p) of one fibre.
skeleton::StretchTerms Fibres::terms(std::size_t l, int j, double stretch, bool with_second) const {
    const OfLink& link = links_[l];
    const double share = link.strengths[j] * link.length * link.length;
    skeleton::StretchTerms sum;
    for (std::size_t e = 0; e < material_.size(); ++e) {
        if (link.by_law && in_sections_[e]) continue;
        sum += (share / 3) * skeleton::uniaxial(*material_[e], link.middle, link.direction, stretch, with_second);
    }
    if (history_) {
        sum += share * skeleton::history_terms(history_, borne_[skeleton::fibres_per_link * l + j], stretch);
    }
    return sum;
}

double Fibres::add_forces(const Poses& poses, double* force) const {
    double energy = 0;
    for (std::size_t l = 0; l < links_.size(); ++l) {
        const OfLink& link = links_[l];
        skeleton::Vec12 g = skeleton::Vec12::Zero();
        if (link.shear != 0) {
            const skeleton::Shear shear(link.length, link.direction, poses.x[link.a], poses.R[link.a], poses.x[link.b],
                                        poses.R[link.b]);
            energy += link.shear * shear.energy();
            shear.add_gradient(link.shear, g);
        }
        if (!material_.empty() || history_) {
            for (int j = 0; j < skeleton::fibres_per_link; ++j) {
                const skeleton::LinkFibre one = fibre(link, j, poses);
                const skeleton::StretchTerms its = terms(l, j, one.stretch(), false);
                energy += its.energy;
                one.add_gradient(its, g);
            }
        }
        double *to_a = force + row_length * link.a, *to_b = force + row_length * link.b;
        for (int c = 0; c < 3; ++c) {
            to_a[c] -= g[c];
            to_a[4 + c] -= g[3 + c];
            to_b[c] -= g[6 + c];
            to_b[4 + c] -= g[9 + c];
        }
    }
    return energy;
}

void Fibres::add_hessian(std::size_t l, const Poses& poses, skeleton::Mat12& H) const {
    const OfLink& link = links_[l];
    if (link.shear != 0) {
        skeleton::Shear(link.length, link.direction, poses.x[link.a], poses.R[link.a], poses.x[link.b], poses.R[link.b])
            .add_hessian(link.shear, H);
    }
    if (material_.empty() && !history_) return;
    for (int j = 0; j < skeleton::fibres_per_link; ++j) {
        const skeleton::LinkFibre one = fibre(link, j, poses);
        one.add_hessian(terms(l, j, one.stretch(), true), H);
    }
}

void Fibres::settle(const Poses& poses) {
    if (!history_) return;
    for (std::size_t l = 0; l < links_.size(); ++l) {
        for (int j = 0; j < skeleton::fibres_per_link; ++j) {
            skeleton::FibreState& had = borne_[skeleton::fibres_per_link * l + j];
            had = skeleton::after_stretch(history_, had, fibre(links_[l], j, poses).stretch());
        }
    }
}

void Fibres::forget() { std::ranges::fill(borne_, skeleton::FibreState()); }

}  // namespace palpate::runtime
