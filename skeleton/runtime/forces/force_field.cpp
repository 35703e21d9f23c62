#include "skeleton/runtime/forces/force_field.h"

#include <algorithm>

#include "skeleton/effects/link_effects.h"
#include "skeleton/links/full_link.h"
#include "skeleton/links/placed/grown_links.h"

namespace palpate::runtime {

namespace {

constexpr int elongation = static_cast<int>(skeleton::Stiffness::elongation);
constexpr int flexion = static_cast<int>(skeleton::Stiffness::flexion);
constexpr int torsion = static_cast<int>(skeleton::Stiffness::torsion);

// Stiffnesses with what effects make of them, but for fibres: a link's twist, and its scale or its section's law.
std::vector<skeleton::Stiffnesses> stiffnesses_in_force(const skeleton::Model& model, const fem::Effects& effects,
                                                        const std::vector<skeleton::SectionLaw>& laws,
                                                        const std::vector<double>& scales) {
    const double twist = skeleton::link_effects(effects).torsion;
    std::vector<skeleton::Stiffnesses> all;
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        skeleton::Stiffnesses k = model.links[l].stiffness;
        k[torsion] += twist * k[flexion];
        const bool by_law = !laws.empty() && laws[l].in_force;
        const skeleton::Stiffnesses factors =
            by_law ? skeleton::Stiffnesses(laws[l].factors) : skeleton::Stiffnesses::Constant(k.size(), scales[l]);
        all.emplace_back(k.cwiseProduct(factors));
    }
    return all;
}

// The links' own, each scaled.
std::vector<skeleton::Stiffnesses> scaled_stiffnesses(const skeleton::Model& model, const std::vector<double>& scales) {
    std::vector<skeleton::Stiffnesses> all;
    for (std::size_t l = 0; l < model.links.size(); ++l) all.push_back(scales[l] * model.links[l].stiffness);
    return all;
}

}  // namespace

ForceField::ForceField(const skeleton::Model& given)
    : model_(given), moves_(given.spheres.size(), 1), poses_(given.spheres.size()) {
    const fem::Effects effects = skeleton::physics_of(given.effects);
    model_.links = skeleton::grown_links(given, effects.growth);
    const skeleton::Model& model = model_;
    laws_ = skeleton::section_laws(given, effects);
    std::vector<double> scales = skeleton::PlacedLinks(given, effects).scales();
    if (scales.empty()) scales.assign(model.links.size(), 1);
    k_ = stiffnesses_in_force(model, effects, laws_, scales);
    if (Fibres::needed(model, effects, laws_))
        fibres_ = std::make_unique<Fibres>(model, effects, skeleton::fibre_lengths(given, model.links),
                                           scaled_stiffnesses(model, scales), laws_);
    if (!effects.points.empty() || !effects.surface.empty() || effects.pressure != 0)
        effects_ = std::make_unique<PointEffects>(model, effects);

    // Where an effect takes the place of the supports, what they held moves, as far as something is joined to it.
    const bool released = fem::release_supports(effects);
    std::vector<char> joined = released ? effects_->supported() : std::vector<char>(model.spheres.size(), 0);
    for (const skeleton::Link& link : model.links) {
        if (released) joined[link.a] = joined[link.b] = 1;
    }
    for (std::size_t i = 0; i < moves_.size(); ++i) moves_[i] = !model.spheres[i].held || joined[i];

    for (const skeleton::Link& link : model.links) {
        pairs_of_link_.push_back({pair(link.a, link.a), pair(link.a, link.b), pair(link.b, link.b)});
    }
    const bool full = !model.links.empty() && model.links.front().section.has_value();
    if (full) {
        for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
            const skeleton::Sphere& sphere = model.spheres[i];
            if (!(sphere.cell > 0) || !(sphere.volume > 0)) continue;
            double scale = 1;
            for (const auto& effect : effects.material) scale *= effect->stiffness(sphere.center);
            Cell& cell = cells_.emplace_back();
            cell.sphere = i;
            cell.stiffness = scale * sphere.volume / sphere.cell;
        }
        make_cells();
    }
    std::vector<char> kept(model.spheres.size(), 0);
    for (const Cell& cell : cells_) kept[cell.sphere] = 1;
    paper_ = paper_table(model, k_);
    full_ = full_table(model, k_, kept);
    couplings_ = coupling_table(laws_);
    if (effects_) effects_->for_each_pair([&](int a, int b) { pair_of_effect_.push_back(pair(a, b)); });
    blocks_.resize(pairs_.size());
}

int ForceField::pair(int a, int b) {
    const std::array<int, 2> key{std::min(a, b), std::max(a, b)};
    const auto [at, fresh] = place_of_pair_.try_emplace(key, static_cast<int>(pairs_.size()));
    if (fresh) pairs_.push_back(key);
    return at->second;
}

void ForceField::make_cells() {
    std::vector<std::vector<int>> links_of(model_.spheres.size());
    for (int l = 0; l < static_cast<int>(model_.links.size()); ++l) {
        links_of[model_.links[l].a].push_back(l);
        links_of[model_.links[l].b].push_back(l);
    }
    std::erase_if(cells_, [&](const Cell& cell) { return links_of[cell.sphere].empty(); });
    for (Cell& cell : cells_) {
        cell.links = links_of[cell.sphere];
        cell.members = {cell.sphere};
        for (const int l : cell.links) {
            const skeleton::Link& link = model_.links[l];
            cell.members.push_back(link.a == cell.sphere ? link.b : link.a);
        }
        for (std::size_t p = 0; p < cell.members.size(); ++p) {
            for (std::size_t q = 0; q < cell.members.size(); ++q) {
                if (cell.members[p] <= cell.members[q]) cell.pairs.push_back(pair(cell.members[p], cell.members[q]));
            }
        }
        cell.gradient.resize(cell.members.size());
    }
    if (cells_.empty()) return;
    swelling_.resize(row_count(model_));
    pressure_.resize(row_count(model_), 0.0);
    swelling_gradient_.resize(model_.links.size());
}

// What the cells bear: pressure from their volumes, on the sections of their links.
double ForceField::set_cell_pressure(const double* pose, const Rates& rates) {
    std::ranges::fill(swelling_, 0.0);
    add_swelling(full_, pose, rates, swelling_.data());
    double energy = 0;
    for (const Cell& cell : cells_) {
        pressure_[cell.sphere] = cell.stiffness * swelling_[cell.sphere];
        energy += 0.5 * pressure_[cell.sphere] * swelling_[cell.sphere];
    }
    return energy;
}

void ForceField::set_pressure(double pressure) {
    if (!effects_) effects_ = std::make_unique<PointEffects>(model_, fem::Effects{});
    effects_->set_pressure(pressure);
}

void ForceField::set_cavity_pressure(int cavity, double pressure) {
    if (!effects_) effects_ = std::make_unique<PointEffects>(model_, fem::Effects{});
    effects_->set_cavity_pressure(cavity, pressure);
}

double ForceField::evaluate(const double* pose, const Rates& rates, double* force) {
    std::fill_n(force, static_cast<std::size_t>(row_length) * row_count(model_), 0.0);
    double energy = add_paper_links(paper_, pose, rates, force);
    if (!full_.empty()) {
        const bool kept = !cells_.empty();
        if (kept) energy += set_cell_pressure(pose, rates);
        energy += add_full_links(full_, couplings_, pose, rates, kept ? pressure_.data() : nullptr, force);
    }
    if (!gravity_.isZero(0)) {
        for (std::size_t i = 0; i < model_.spheres.size(); ++i) {
            const Vec3 weight = model_.spheres[i].mass * gravity_;
            Eigen::Map<Vec3>(force + row_length * i) += weight;
            energy -= weight.dot(Eigen::Map<const Vec3>(pose + row_length * i) - model_.spheres[i].center);
        }
    }
    if (fibres_) {
        poses_.assign(pose);
        energy += fibres_->add_forces(poses_, force);
    }
    if (effects_) energy += effects_->add_forces(pose, force);
    return energy;
}

const std::vector<ForceField::Block>& ForceField::curvature(const double* pose) {
    poses_.assign(pose);
    for (Block& block : blocks_) block.setZero();
    if (!cells_.empty()) set_cell_pressure(pose, {});
    add_link_curvature();
    add_cell_curvature();
    if (effects_) {
        auto next = pair_of_effect_.begin();
        effects_->for_each_block(pose, [&](const Block& block) { blocks_[*next++] += block; });
    }
    return blocks_;
}

void ForceField::add_link_curvature() {
    for (std::size_t l = 0; l < model_.links.size(); ++l) {
        const skeleton::Link& link = model_.links[l];
        const Vec3 &x_a = poses_.x[link.a], &x_b = poses_.x[link.b];
        const Mat3 &R_a = poses_.R[link.a], &R_b = poses_.R[link.b];
        const Vec3 &X_a = model_.spheres[link.a].center, &X_b = model_.spheres[link.b].center;
        skeleton::Mat12 H;
        if (link.section) {
            skeleton::FullLink now(*link.section, link.length, X_a, X_b, x_a, R_a, x_b, R_b);
            if (!laws_.empty() && laws_[l].in_force) now.couple(laws_[l].coupling);
            skeleton::FullLink::Strains factors = k_[l].cwiseProduct(now.strains());
            if (!cells_.empty()) {
                const double half = 0.5 * link.section->area;
                factors[elongation] += half * (pressure_[link.a] + pressure_[link.b]);
                swelling_gradient_[l] = half * now.gradients().col(elongation);
            }
            H.noalias() =
                now.gradients() * skeleton::FullLink::Strains(k_[l]).asDiagonal() * now.gradients().transpose();
            now.add_curvature(factors, H);
        } else {
            H = skeleton::link_hessian(k_[l], link.length, (X_b - X_a).normalized(), x_a, R_a, x_b, R_b);
        }
        if (fibres_) fibres_->add_hessian(l, poses_, H);
        blocks_[pairs_of_link_[l][0]] += H.topLeftCorner<6, 6>();
        blocks_[pairs_of_link_[l][2]] += H.bottomRightCorner<6, 6>();
        if (link.a < link.b) {
            blocks_[pairs_of_link_[l][1]] += H.topRightCorner<6, 6>();
        } else {
            blocks_[pairs_of_link_[l][1]] += H.bottomLeftCorner<6, 6>();
        }
    }
}

// k / V times the square of each cell's gradient; that of its first member sums what its links' ends there do.
void ForceField::add_cell_curvature() {
    for (Cell& cell : cells_) {
        cell.gradient.front().setZero();
        for (std::size_t i = 0; i < cell.links.size(); ++i) {
            const int l = cell.links[i];
            const bool from_a = model_.links[l].a == cell.sphere;
            const Eigen::Matrix<double, 12, 1>& g = swelling_gradient_[l];
            cell.gradient.front() += from_a ? g.head<6>() : g.tail<6>();
            cell.gradient[i + 1] = from_a ? g.tail<6>() : g.head<6>();
        }
        auto next = cell.pairs.begin();
        for (std::size_t p = 0; p < cell.members.size(); ++p) {
            for (std::size_t q = 0; q < cell.members.size(); ++q) {
                if (cell.members[p] > cell.members[q]) continue;
                blocks_[*next++].noalias() += cell.stiffness * cell.gradient[p] * cell.gradient[q].transpose();
            }
        }
    }
}

void ForceField::settle(const double* pose) {
    if (!remembers()) return;
    poses_.assign(pose);
    fibres_->settle(poses_);
}

void ForceField::forget() {
    if (fibres_) fibres_->forget();
}

}  // namespace palpate::runtime
