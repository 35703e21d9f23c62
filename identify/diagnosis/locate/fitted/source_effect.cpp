#include "identify/diagnosis/locate/fitted/source_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::identify {
namespace {

// First order tells of a large change only that it is large: a fit begins within these bounds, and may leave them.
// Design choice: from farther out bodies more often have no equilibrium, and the source is not fitted.
constexpr double most_times_as_stiff = 8;
constexpr double most_shrunk = -0.3, most_grown = 0.5;  // of every free length: to a third of the volume, 3.4 times it

/// Of a ball whose points lie as far from its middle, rms, as a Gaussian weight does: 3/5 R^2 = 3 sd^2.
const double radius_in_sd = std::sqrt(5.0);

void tell_vector(const std::array<const char*, 3>& names, const Vec3& v, const char* unit,
                 skeleton::EffectRecord& effect) {
    for (int a = 0; a < 3; ++a) effect.parameters.push_back({names[a], v[a], unit});
}

}  // namespace

const char* effect_of(const SourceTerm& term) {
    const bool is_constant = term.law == SourceLaw::constant;
    switch (term.form) {
        case SourceForm::force:
        case SourceForm::traction:
            return is_constant ? "local-force" : "";
        case SourceForm::normal:
            if (term.law == SourceLaw::spring) return term.mean[0] > 0 ? "local-springs" : "";
            return is_constant ? "local-force" : "";
        case SourceForm::growth:
            return is_constant && std::isfinite(term.radius) ? "local-swelling" : "";
        case SourceForm::softening:
            return is_constant && std::isfinite(term.radius) ? "inclusion" : "";
        default:
            return "";
    }
}

skeleton::EffectRecord record_of(const SourceTerm& term, double size) {
    skeleton::EffectRecord effect{effect_of(term), {}};
    tell_vector({"cx", "cy", "cz"}, term.centre, "mm", effect);
    const double sd = std::min(term.radius, size);
    if (term.form == SourceForm::softening) {
        const double most = std::log(most_times_as_stiff);
        effect.parameters.push_back({"radius", radius_in_sd * sd, "mm"});
        effect.parameters.push_back({"ratio", std::exp(std::clamp(term.mean[0], -most, most)), "1"});
        return effect;
    }
    effect.parameters.push_back({"radius", sd, "mm"});
    if (term.law == SourceLaw::spring) {
        effect.parameters.push_back({"stiffness", term.mean[0], "N/mm"});
    } else if (term.form == SourceForm::growth) {
        effect.parameters.push_back({"growth", std::clamp(term.mean[0], most_shrunk, most_grown), "1"});
    } else {
        const Vec3 force = term.form == SourceForm::normal ? Vec3(term.mean[0] * term.axis) : Vec3(term.mean.head<3>());
        tell_vector({"fx", "fy", "fz"}, force, "N", effect);
    }
    return effect;
}

SourceTerm term_of(const SourceTerm& located, const Refit& fit) {
    const Eigen::VectorXd& values = fit.explanation.values.back();
    const Eigen::Index count = values.size(), first = fit.explanation.all().size() - count;
    const Eigen::MatrixXd covariance = fit.covariance.block(first, first, count, count);
    SourceTerm term = located;
    term.centre = values.head<3>();
    term.radius = std::exp(values[3]);
    term.probability = 1;
    Eigen::MatrixXd by_value;  // d numbers / d values behind the place
    if (located.form == SourceForm::softening) {
        term.radius /= radius_in_sd;
        term.mean = values.tail(1);  // ln ratio
        by_value = Eigen::MatrixXd::Identity(1, 1);
    } else if (located.form == SourceForm::growth) {
        term.mean = values.tail(1);
        by_value = Eigen::MatrixXd::Identity(1, 1);
    } else if (located.law == SourceLaw::spring) {
        term.mean = values.tail(1).array().exp();
        by_value = term.mean.asDiagonal();
    } else {
        term.form = located.form == SourceForm::force ? SourceForm::force : SourceForm::traction;
        term.mean = values.tail<3>();
        by_value = Mat3::Identity();
    }
    const Eigen::Index numbers = term.mean.size();
    term.covariance = by_value * covariance.bottomRightCorner(numbers, numbers) * by_value.transpose();
    term.sd = term.covariance.diagonal().cwiseSqrt();
    return term;
}

}  // namespace palpate::identify
