#include "skeleton/links/sections/section_law.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "skeleton/links/sections/section_shape.h"

namespace palpate::skeleton {

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr int slices = 8;          // along a link
constexpr double poisson = 0.49;   // soft bodies keep their volume, nearly; all is told as a share of the shear modulus
constexpr double kappa = 5.0 / 6;  // of shear, as start_stiffness has it

// Generalized strains by their place in Stiffness.
constexpr int axial = 0, bend_1 = 1, twist = 2, bend_2 = 3, cut_1 = 4, cut_2 = 5;

// Strains xx, xy, xz, yy, zz, yz in the axes of a link, as matrices; of shears, twice each, half.
std::array<Mat3, 6> unit_strains(const Mat3& axes) {
    constexpr std::array<std::array<int, 2>, 6> of{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {2, 2}, {1, 2}}};
    std::array<Mat3, 6> all;
    for (std::size_t p = 0; p < of.size(); ++p) {
        const Vec3 i = axes.row(of[p][0]).transpose(), j = axes.row(of[p][1]).transpose();
        all[p] = 0.5 * (i * j.transpose() + j * i.transpose());
    }
    return all;
}

// The material's moduli over its shear modulus, of the strains above.
Mat6 moduli(const Mat3& axes, const std::vector<std::shared_ptr<const fem::MaterialEffect>>& effects, const Vec3& X) {
    Mat6 C = Mat6::Zero();
    constexpr std::array<int, 3> normal{0, 3, 4};
    for (const int p : normal) {
        C(p, p) += 2;
        for (const int q : normal) C(p, q) += 2 * poisson / (1 - 2 * poisson);
    }
    for (const int p : {1, 2, 5}) C(p, p) = 1;
    const std::array<Mat3, 6> strains = unit_strains(axes);
    for (const auto& effect : effects) {
        if (effect->is_scale() || !acts_in_sections(*effect, X)) continue;
        const fem::MaterialTerms terms = effect->terms(X, Mat3::Identity(), true);
        for (int p = 0; p < 6; ++p)
            for (int q = 0; q < 6; ++q) C(p, q) += strains[p].reshaped().dot(terms.second * strains[q].reshaped());
    }
    return C;
}

// Of a beam's material: no stress yy, zz, yz.
Mat3 beam_moduli(const Mat6& C) {
    return C.topLeftCorner<3, 3>() -
           C.topRightCorner<3, 3>() * C.bottomRightCorner<3, 3>().ldlt().solve(C.bottomLeftCorner<3, 3>());
}

// gamma_xx = e - y k_z + z k_y, gamma_xy = g_y - z t, gamma_xz = g_z + y t.
Eigen::Matrix<double, 3, 6> strains_at(double y, double z) {
    Eigen::Matrix<double, 3, 6> B = Eigen::Matrix<double, 3, 6>::Zero();
    B(0, axial) = 1;
    B(0, bend_1) = -y;
    B(0, bend_2) = z;
    B(1, cut_1) = 1;
    B(1, twist) = -z;
    B(2, cut_2) = 1;
    B(2, twist) = y;
    return B;
}

// Forces at the place s along a link from those in its middle: shear forces bend.
Mat6 forces_at(double s) {
    Mat6 H = Mat6::Identity();
    H(bend_1, cut_1) = -s;
    H(bend_2, cut_2) = s;
    return H;
}

// Softness of a link of the moduli Q whose sections are scaled by `scale`(slice, place), to which `correct` makes a sum
// of strains over the section a beam's.
template <typename Scale>
Mat6 stiffness_of(const SectionShape& shape, double length, const Mat3& Q, const Vec6& correct, const Scale& scale) {
    const SectionPlaces places = section_places(shape);
    Mat6 softness = Mat6::Zero();
    for (int i = 0; i < slices; ++i) {
        Mat6 K = Mat6::Zero();
        for (int j = 0; j < fibres_per_link; ++j) {
            const Eigen::Matrix<double, 3, 6> B = strains_at(places[j].x(), places[j].y());
            K += fibre_weight * shape.area * scale(i, places[j]) * B.transpose() * Q * B;
        }
        K = correct.asDiagonal() * K * correct.asDiagonal();
        const Mat6 inverse = K.inverse();
        // Gauss's two points in each slice integrate s^2 exactly.
        for (const double side : {-1.0, 1.0}) {
            const double s = length * ((i + 0.5 * (1 + side / std::sqrt(3.0))) / slices - 0.5);
            const Mat6 H = forces_at(s);
            softness += 0.5 * length / slices * H.transpose() * inverse * H;
        }
    }
    return softness.inverse();
}

SectionLaw law_of(const Model& model, const Link& link, const fem::Effects& effects) {
    const SectionShape shape = section_shape(link);
    SectionLaw law;
    if (!(shape.sd_1 > 0 && shape.sd_2 > 0)) return law;
    const LinkSection& section = *link.section;
    const Vec3 axis = model.spheres[link.b].center - model.spheres[link.a].center;
    const double length = axis.norm(),
                 middle = 0.5 * section.axes.row(0).dot(model.spheres[link.a].center + model.spheres[link.b].center -
                                                        2 * section.at);
    // Isotropic material in an ellipse: torsion 4 I_1 I_2 / (I_1 + I_2) for I_1 + I_2, shear kappa A for A.
    const double I_1 = shape.sd_1 * shape.sd_1, I_2 = shape.sd_2 * shape.sd_2;
    Vec6 correct = Vec6::Ones();
    correct[twist] = 2 * std::sqrt(I_1 * I_2) / (I_1 + I_2);
    correct[cut_1] = correct[cut_2] = std::sqrt(kappa);

    const auto scale = [&](int slice, const Eigen::Vector2d& place) {
        const double s = middle + length * ((slice + 0.5) / slices - 0.5);
        const Vec3 X = section.at + section.axes.transpose() * Vec3(s, place.x(), place.y());
        double product = 1;
        for (const auto& effect : effects.material) product *= effect->stiffness(X);
        return product;
    };
    const Vec3 X = 0.5 * (model.spheres[link.a].center + model.spheres[link.b].center);
    const Mat6 with =
        stiffness_of(shape, length, beam_moduli(moduli(section.axes, effects.material, X)), correct, scale);
    const Mat6 without = stiffness_of(shape, length, beam_moduli(moduli(section.axes, {}, X)), correct,
                                      [](int, const Eigen::Vector2d&) { return 1.0; });

    // Without pivoting: K = L D L^T, so C = L^T.
    Mat6 rest = with;
    for (int j = 0; j < 6; ++j) {
        const double pivot = rest(j, j);
        law.factors[j] = pivot / without(j, j);
        law.coupling.row(j).tail(6 - j) = rest.row(j).tail(6 - j) / pivot;
        const Vec6 column = rest.col(j);
        rest -= column * column.transpose() / pivot;
    }
    law.in_force = true;
    return law;
}

}  // namespace

bool acts_in_sections(const fem::MaterialEffect& effect, const Vec3& X) {
    if (effect.is_scale()) return true;
    const fem::MaterialTerms terms = effect.terms(X, Mat3::Identity(), true);
    constexpr double rounding = 1e-12;  // of directions of unit length, and what is made of them
    return terms.first.norm() < rounding * terms.second.norm();
}

std::vector<SectionLaw> section_laws(const Model& model, const fem::Effects& effects) {
    std::vector<SectionLaw> laws;
    if (model.links.empty() || !model.links.front().section) return laws;
    const Vec3 anywhere = model.spheres.front().center;
    const bool needed =
        std::ranges::any_of(effects.material, [&](const auto& effect) { return acts_in_sections(*effect, anywhere); });
    if (!needed) return laws;
    laws.reserve(model.links.size());
    for (const Link& link : model.links) {
        const bool lump = model.spheres[link.a].volume > 0 || model.spheres[link.b].volume > 0;
        laws.push_back(lump ? SectionLaw() : law_of(model, link, effects));
    }
    return laws;
}

}  // namespace palpate::skeleton
