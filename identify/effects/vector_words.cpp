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

/// "x" for either sense of a line along it.
std::string line_in_words(const Vec3& axis) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    const std::string words = direction_in_words(axis[largest] < 0 ? Vec3(-axis) : axis);
    return words.starts_with('+') ? words.substr(1) : words;
}

}  // namespace

std::string direction_in_words(const Vec3& direction) {
    const Vec3 unit = direction.normalized();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(unit[axis]) > near_axis) return fmt::format("{}{}", unit[axis] < 0 ? '-' : '+', "xyz"[axis]);
    }
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", unit.x(), unit.y(), unit.z());
}

std::string vector_in_words(const Vec3& v, const Mat3& covariance, double unit, const std::string& unit_name,
                            const std::string& preposition) {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(covariance);  // the best known first
    const Vec3 sd = axes.eigenvalues().cwiseMax(0).cwiseSqrt();

    // An axis along which much of what is known otherwise could be hidden is not determined.
    constexpr double much = 0.25, several = 3;
    Vec3 known = v;
    std::vector<std::string> open;
    for (int a = 2; a > 0; --a) {
        const Vec3 axis = axes.eigenvectors().col(a), others = known - axis * axis.dot(known);
        if (sd[a] < much * others.norm() || sd[a] < several * sd[0] || others.isZero(0)) break;
        known = others;
        open.push_back(line_in_words(axis));
    }
    if (known.isZero(0)) return "0 " + unit_name;

    const Vec3 towards = known.normalized();
    const double sd_of_size = std::sqrt(std::max(towards.dot(covariance * towards), 0.0));
    std::string text = fmt::format("{} {} {} {}", mesh::with_sd(known.norm() / unit, sd_of_size / unit), unit_name,
                                   preposition, direction_in_words(towards));
    if (!open.empty()) text += fmt::format("; {} {} it is not determined", preposition, fmt::join(open, " and "));
    return text;
}

}  // namespace palpate::identify
