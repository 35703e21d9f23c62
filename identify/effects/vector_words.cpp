#include "identify/effects/vector_words.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <vector>

#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

constexpr double near_axis = 0.985;  // cosine of ten degrees

/// A line's direction in its positive sense; an axis of the frame where it lies as near to it as words tell.
Vec3 line_along(const Vec3& axis) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (std::abs(axis[largest]) > near_axis) return Vec3::Unit(largest);
    return axis[largest] < 0 ? Vec3(-axis) : axis;
}

/// "x" for a line along it.
std::string line_in_words(const Vec3& line) {
    const std::string words = direction_in_words(line);
    return words.starts_with('+') ? words.substr(1) : words;
}

}  // namespace

std::string components_in_words(const Vec3& unit) {
    const Vec3 rounded = (100 * unit).array().round() / 100 + 0.0;  // -0 + 0 is 0: no "-0.00"
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", rounded.x(), rounded.y(), rounded.z());
}

std::string direction_in_words(const Vec3& direction) {
    const Vec3 unit = direction.normalized();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(unit[axis]) > near_axis) return fmt::format("{}{}", unit[axis] < 0 ? '-' : '+', "xyz"[axis]);
    }
    return components_in_words(unit);
}

bool is_undetermined(const VectorComponent& component) {
    constexpr double two_sided = 2, share = 0.25, ratio = 3;
    return std::abs(component.value) <= two_sided * component.sd && component.sd >= share * component.rest &&
           component.sd >= ratio * component.least_sd;
}

std::string number_in_words(const skeleton::EffectRecord& record, std::size_t number, const Eigen::MatrixXd& covariance,
                            double factor) {
    const auto n = static_cast<Eigen::Index>(number);
    const double sd = covariance.size() > 0 ? std::sqrt(std::max(covariance(n, n), 0.0)) : 0;
    return mesh::with_sd(factor * record.parameters[number].value, std::abs(factor) * sd);
}

std::string vector_in_words(const Vec3& v, const Mat3& covariance, double unit, const std::string& unit_name,
                            const std::string& preposition) {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(covariance);  // the best known first
    const Vec3 sd = axes.eigenvalues().cwiseMax(0).cwiseSqrt();

    Vec3 known = v;
    std::vector<std::string> open;
    for (int a = 2; a > 0; --a) {
        const Vec3 axis = line_along(axes.eigenvectors().col(a)), others = known - axis * axis.dot(known);
        if (others.isZero(0) || !is_undetermined({axis.dot(known), sd[a], others.norm(), sd[0]})) break;
        known = others;
        open.push_back(fmt::format("{} {} it is not determined ({})", preposition, line_in_words(axis),
                                   mesh::with_sd(axis.dot(v) / unit, sd[a] / unit)));
    }
    if (known.isZero(0)) return "0 " + unit_name;

    const Vec3 towards = known.normalized();
    const double sd_of_size = std::sqrt(std::max(towards.dot(covariance * towards), 0.0));
    std::string text = fmt::format("{} {} {} {}", mesh::with_sd(known.norm() / unit, sd_of_size / unit), unit_name,
                                   preposition, direction_in_words(towards));
    for (const std::string& one : open) text += "; " + one;
    return text;
}

}  // namespace palpate::identify
