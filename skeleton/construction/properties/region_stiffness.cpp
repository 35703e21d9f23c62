#include "skeleton/construction/properties/region_stiffness.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "skeleton/links/fibres/link_fibre.h"

namespace palpate::skeleton {
namespace {

constexpr int slices = 12;  // along a link
constexpr int rings = 5, on_ring = 12;

constexpr int axial = 0, bend_1 = 1, twist = 2, bend_2 = 3, cut_1 = 4, cut_2 = 5;  // places in Stiffness

/// Points of a disc of unit variance in each direction, of equal area.
std::vector<Eigen::Vector2d> disc_points() {
    std::vector<Eigen::Vector2d> points;
    points.reserve(std::size_t{rings} * on_ring);
    double squares = 0;
    for (int r = 0; r < rings; ++r) {
        const double radius = std::sqrt((r + 0.5) / rings);
        for (int k = 0; k < on_ring; ++k) {
            const double angle = 2 * std::numbers::pi * (k + 0.5 * (r % 2)) / on_ring;
            points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
            squares += radius * radius / 2;
        }
    }
    const double sd = std::sqrt(squares / static_cast<double>(points.size()));
    for (Eigen::Vector2d& point : points) point /= sd;
    return points;
}

/// What a section bears, over what it would without the field.
struct SectionShares {
    double area = 1, moment_1 = 1, moment_2 = 1, polar = 1;
};

/// Integrals over a section of the field s at its points: of s, and of s times squares about the neutral axis.
SectionShares shares_of(const std::vector<Eigen::Vector2d>& places, const Eigen::VectorXd& s) {
    const auto n = static_cast<double>(places.size());
    Eigen::Vector2d first = Eigen::Vector2d::Zero(), second = first, even = first;
    for (std::size_t i = 0; i < places.size(); ++i) {
        first += s[static_cast<Eigen::Index>(i)] * places[i];
        second += s[static_cast<Eigen::Index>(i)] * places[i].cwiseAbs2();
        even += places[i].cwiseAbs2();
    }
    const Eigen::Vector2d about_axis = second - first.cwiseAbs2() / s.sum();
    return {s.sum() / n, about_axis[0] / even[0], about_axis[1] / even[1], about_axis.sum() / even.sum()};
}

/// Radii of gyration along the axes of a link's section, by its flexions.
Eigen::Vector2d reach_of(const Link& link) {
    const double gyration = radius_of_gyration(link);
    const double k_1 = link.stiffness[bend_1], k_2 = link.stiffness[bend_2];
    const double area = link.section->area;
    if (!(k_1 > 0 && k_2 > 0 && area > 0)) return {gyration, gyration};
    // The ratio of the moments is that of the flexions, their product that of a section which fills its area.
    const double ratio = std::sqrt(k_1 / k_2), mean = std::sqrt(area / (4 * std::numbers::pi));
    return {mean * std::sqrt(ratio), mean / std::sqrt(ratio)};
}

void apply_to_link(const StiffnessField& field, const Model& model, const std::vector<Eigen::Vector2d>& disc,
                   Link& link) {
    const LinkSection& section = *link.section;
    const Vec3 from = model.spheres[link.a].center, axis = model.spheres[link.b].center - from;
    const Eigen::Vector2d reach = reach_of(link);
    std::vector<Eigen::Vector2d> places;
    places.reserve(disc.size());
    for (const Eigen::Vector2d& point : disc) places.emplace_back(reach.cwiseProduct(point));
    const Vec3 aside = section.at - from - section.axes.row(0).dot(section.at - from) * section.axes.row(0).transpose();

    // Softnesses over the mean along the link, each over what it is without the field.
    double area = 0, moment_1 = 0, moment_2 = 0, polar = 0, sheared_1 = 0, sheared_2 = 0;
    Eigen::VectorXd s(std::ssize(places));
    for (int i = 0; i < slices; ++i) {
        const double at = (i + 0.5) / slices;
        for (std::size_t p = 0; p < places.size(); ++p)
            s[static_cast<Eigen::Index>(p)] =
                field(from + at * axis + aside +
                      section.axes.bottomRows<2>().transpose() * Eigen::Vector2d(places[p].x(), places[p].y()));
        const SectionShares shares = shares_of(places, s);
        area += 1 / shares.area / slices;
        moment_1 += 1 / shares.moment_1 / slices;
        moment_2 += 1 / shares.moment_2 / slices;
        polar += 1 / shares.polar / slices;
        // Shear forces in the middle bend the ends: in proportion to the distance, squared.
        const double arm = 12 * (at - 0.5) * (at - 0.5) / (1 - 1.0 / (slices * slices));
        sheared_1 += arm / shares.moment_1 / slices;
        sheared_2 += arm / shares.moment_2 / slices;
    }

    // In a beam's shear 1 / k = what shears + L^2 / (12 k_flexion); in a lump's, which has no such part, all shears.
    const auto with_shear = [&](double k, double k_flexion, double bent) {
        const double bending = link.length * link.length / (12 * k_flexion);
        const bool is_beam = model.spheres[link.a].volume == 0 && model.spheres[link.b].volume == 0;
        if (!(is_beam && k_flexion > 0 && bending < 1 / k)) return k / area;
        return 1 / ((1 / k - bending) * area + bending * bent);
    };
    Stiffnesses& k = link.stiffness;
    k[cut_1] = with_shear(k[cut_1], k[bend_1], sheared_1);
    k[cut_2] = with_shear(k[cut_2], k[bend_2], sheared_2);
    k[axial] /= area;
    k[bend_1] /= moment_1;
    k[bend_2] /= moment_2;
    k[twist] /= polar;
}

/// The Reuss mean over a ball: what is softest gives way.
double mean_over(const StiffnessField& field, const Sphere& sphere) {
    constexpr int across = 5;  // points of a grid
    double softness = 0;
    int count = 0;
    for (int i = 0; i < across * across * across; ++i) {
        const Eigen::Array3i cell(i % across, i / across % across, i / (across * across));
        const Vec3 off = (cell.cast<double>() + 0.5) * 2.0 / across - 1;
        if (off.norm() > 1) continue;
        softness += 1 / field(sphere.center + sphere.radius * off);
        ++count;
    }
    return count / softness;
}

}  // namespace

void apply_field(const StiffnessField& field, Model& model) {
    const std::vector<Eigen::Vector2d> disc = disc_points();
    for (Link& link : model.links)
        if (link.section) apply_to_link(field, model, disc, link);
    for (Sphere& sphere : model.spheres)
        if (sphere.volume > 0) sphere.volume *= mean_over(field, sphere);
}

}  // namespace palpate::skeleton
