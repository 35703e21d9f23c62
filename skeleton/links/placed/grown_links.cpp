#include "skeleton/links/placed/grown_links.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "skeleton/links/rest_direction.h"
#include "skeleton/links/sections/section_shape.h"

namespace palpate::skeleton {

namespace {

constexpr int growth_slices = 8;  // along a link

using Strains = Eigen::Matrix<double, 6, 1>;

double& strain(Strains& s, Stiffness kind) { return s[static_cast<int>(kind)]; }
double strain(const Strains& s, Stiffness kind) { return s[static_cast<int>(kind)]; }

// What a full link's material has grown by, as strains of the link.
Strains natural_strains(const Model& model, const Link& link, const fem::Growth& growth) {
    const LinkSection& section = *link.section;
    const Vec3 along = section.axes.row(0).transpose(), f_1 = section.axes.row(1).transpose(),
               f_2 = section.axes.row(2).transpose();
    const Vec3 &X_a = model.spheres[link.a].center, &X_b = model.spheres[link.b].center;
    const SectionShape shape = section_shape(link);
    const SectionPlaces places = section_places(shape);
    const double a = along.dot(X_a - section.at), b = along.dot(X_b - section.at), slice = (b - a) / growth_slices;
    Strains s = Strains::Zero();
    for (int i = 0; i < growth_slices; ++i) {
        const double x = a + (i + 0.5) * slice;
        double mean = 0;
        Eigen::Vector2d slope = Eigen::Vector2d::Zero();
        for (const Eigen::Vector2d& place : places) {
            const double g = growth.at(section.at + x * along + place[0] * f_1 + place[1] * f_2);
            mean += fibre_weight * g;
            slope += fibre_weight * g * place;
        }
        strain(s, Stiffness::elongation) += mean * link.length / growth_slices;
        // About f_2 and f_1; what lies beyond a turn at x moves by it, so that ends which meet in the section part.
        const double turn = shape.sd_1 > 0 ? -slope[0] / (shape.sd_1 * shape.sd_1) * slice : 0;
        const double turn_2 = shape.sd_2 > 0 ? slope[1] / (shape.sd_2 * shape.sd_2) * slice : 0;
        strain(s, Stiffness::flexion) += turn;
        strain(s, Stiffness::flexion_2) += turn_2;
        strain(s, Stiffness::shear) -= x * turn;
        strain(s, Stiffness::shear_2) += x * turn_2;
    }
    // A strain of turning is twice the sine of half the angle; halves that meet in the middle stand for no sharper
    // curl.
    const double angle = std::hypot(strain(s, Stiffness::flexion), strain(s, Stiffness::flexion_2));
    if (angle > 0) {
        const double sine = 2 * std::sin(0.5 * std::min(angle, 0.5 * std::numbers::pi)) / angle;
        strain(s, Stiffness::flexion) *= sine;
        strain(s, Stiffness::flexion_2) *= sine;
    }
    return s;
}

// Ends that are strained by `s`, where X are at rest: see FullLink.
LinkPose strained(const Link& link, const LinkPose& rest, const Strains& s) {
    const LinkSection& section = *link.section;
    const Mat3 axes = section.axes.transpose();
    const Vec3 vector = 0.5 * (axes * Vec3(strain(s, Stiffness::torsion), strain(s, Stiffness::flexion_2),
                                           strain(s, Stiffness::flexion)));
    const Eigen::Quaterniond turn(std::sqrt(std::max(0.0, 1 - vector.squaredNorm())), vector.x(), vector.y(),
                                  vector.z());
    LinkPose ends = rest;
    ends.R_b = turn.toRotationMatrix();
    const Mat3 mean = 0.5 * (axes + ends.R_b * axes);
    const Vec3 gap = mean.transpose().inverse() *
                     Vec3(strain(s, Stiffness::elongation), strain(s, Stiffness::shear), strain(s, Stiffness::shear_2));
    ends.x_b = section.at + gap - ends.R_b * (section.at - rest.x_b);
    return ends;
}

}  // namespace

std::vector<Link> grown_links(const Model& model, const fem::Growth& growth) {
    std::vector<Link> links = model.links;
    for (Link& link : links) {
        if (!link.section || growth.parts.empty()) {
            link.length *= 1 + growth.between(model.spheres[link.a].center, model.spheres[link.b].center);
            continue;
        }
        Strains s = natural_strains(model, link, growth);
        link.length += strain(s, Stiffness::elongation);
        strain(s, Stiffness::elongation) = 0;
        link.section->natural = s;
    }
    return links;
}

std::vector<LinkPose> natural_poses(const Model& model, const std::vector<Link>& grown) {
    std::vector<LinkPose> poses = straight_poses(model, grown);
    const State rest = rest_state(model);
    for (std::size_t l = 0; l < grown.size(); ++l) {
        if (!grown[l].section || grown[l].section->natural.isZero(0)) continue;
        Strains s = grown[l].section->natural;
        strain(s, Stiffness::elongation) = grown[l].length - model.links[l].length;
        poses[l] = strained(grown[l], pose(grown[l], rest), s);
    }
    return poses;
}

std::vector<LinkPose> straight_poses(const Model& model, const std::vector<Link>& grown) {
    const State rest = rest_state(model);
    std::vector<LinkPose> poses;
    poses.reserve(grown.size());
    for (std::size_t l = 0; l < grown.size(); ++l) {
        LinkPose& ends = poses.emplace_back(pose(grown[l], rest));
        const double factor = grown[l].length / model.links[l].length;
        if (factor != 1) ends.x_b = ends.x_a + factor * (ends.x_b - ends.x_a);
    }
    return poses;
}

std::vector<FibreLengths> fibre_lengths(const Model& model, const std::vector<Link>& grown) {
    const std::vector<LinkPose> natural = natural_poses(model, grown);
    std::vector<FibreLengths> all(grown.size());
    for (std::size_t l = 0; l < grown.size(); ++l) {
        const LinkPose& ends = natural[l];
        const Link& link = model.links[l];
        // A link may rest at another length than its spheres' distance: its fibres do, too.
        const double longer = link.length - (model.spheres[link.b].center - model.spheres[link.a].center).norm();
        const FibreOffsets offsets = fibre_offsets(link, rest_direction(model, link));
        for (int j = 0; j < fibres_per_link; ++j)
            all[l][j] = (ends.x_b + ends.R_b * offsets[j] - ends.x_a - ends.R_a * offsets[j]).norm() + longer;
    }
    return all;
}

}  // namespace palpate::skeleton
