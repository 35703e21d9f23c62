#include "identify/diagnosis/locate/missing_source.h"

#include <fmt/format.h>

#include <cmath>

#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

/// "0.31 +- 0.04".
std::string with_sd(double value, double sd) { return fmt::format("{:.2g} ± {:.1g}", value, sd); }

std::string law_in_words(const SourceTerm& term) {
    switch (term.law) {
        case SourceLaw::constant:
            return "alike in all states";
        case SourceLaw::proportional:
            return "in proportion to the load";
        case SourceLaw::quadratic:
            return "with the square of the load";
        case SourceLaw::with_time:
            return "with the logarithm of the time since a probe began";
        case SourceLaw::with_history:
            return "with the largest load so far";
        case SourceLaw::spring:
            return "against the body's motion there, as springs do";
        case SourceLaw::one_sided:
            return term.gap > 0 ? fmt::format("once the body has moved outward by {:.2g} mm there", term.gap)
                                : "where the body moves outward there, on one side only";
        case SourceLaw::with_strain:
            return "with its strain";
        case SourceLaw::reaction:
            return "in proportion to the force on the supports";
        case SourceLaw::one_probe:
            return fmt::format("in probe {} alone", term.number);
        case SourceLaw::some_states:
            return fmt::format("alike in {:.0f} of the {} states, and not in the others", term.strength.sum(),
                               term.strength.size());
        case SourceLaw::irregular:
            return "in some states more than in others, by no simple law of the load";
    }
    return {};
}

std::string place_in_words(const MissingSource& source, const SourceTerm& term) {
    const std::string at = fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", source.at.x(), source.at.y(), source.at.z());
    if (std::isinf(term.radius)) return "all over the body";
    return fmt::format("around {}, within {:.2g} mm", at, source.spread);
}

std::string vector_in_short(const MissingSource& source, const SourceTerm& term, const char* unit) {
    const Vec3 v = term.mean.head<3>();
    const double sd = std::sqrt(source.direction.dot(term.covariance.topLeftCorner<3, 3>() * source.direction));
    return fmt::format("{} {} towards {}", with_sd(v.norm(), sd), unit, components_in_words(source.direction));
}

}  // namespace

bool is_vector(SourceForm form) {
    return form == SourceForm::force || form == SourceForm::traction || form == SourceForm::marker;
}

WeightPlace place_of(const Eigen::VectorXd& weight, const Points& points) {
    WeightPlace place{.norm = weight.sum()};
    if (!(place.norm > 0)) return place;
    place.centroid = points.transpose() * weight / place.norm;
    place.extent =
        std::sqrt(weight.dot((points.rowwise() - place.centroid.transpose()).rowwise().squaredNorm()) / place.norm);
    return place;
}

Eigen::VectorXd source_weight(const Vec3& centre, double radius, const Points& points) {
    if (std::isinf(radius)) return Eigen::VectorXd::Ones(points.rows());
    const Eigen::ArrayXd d2 = (points.rowwise() - centre.transpose()).rowwise().squaredNorm() / (radius * radius);
    return (-0.5 * d2).exp();
}

SourceField field_of(const MissingSource& source, const Points& points, int state) {
    SourceField field{Points::Zero(points.rows(), 3), Eigen::VectorXd::Zero(points.rows())};
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(points.rows());
    for (const SourceTerm& term : source.terms) {
        if (term.mean.size() == 0) continue;
        const bool vector = is_vector(term.form);
        const bool is_force =
            term.form == SourceForm::force || term.form == SourceForm::traction || term.form == SourceForm::normal;
        const Eigen::VectorXd weight =
            term.strength[state] / (is_force ? term.norm : 1) * source_weight(term.centre, term.radius, points);
        const Eigen::Index numbers = vector ? 3 : 1;
        const Vec3 mean = vector ? Vec3(term.mean.head<3>()) : Vec3(term.mean[0], 0, 0);
        field.mean += term.probability * weight * mean.transpose();
        squares += term.probability * weight.cwiseAbs2() *
                   (mean.squaredNorm() + term.covariance.topLeftCorner(numbers, numbers).trace());
    }
    field.sd = (squares - field.mean.rowwise().squaredNorm()).cwiseMax(0).cwiseSqrt();
    return field;
}

std::optional<MissingSource::Magnitude> MissingSource::magnitude() const {
    const SourceTerm& term = likeliest();
    if (term.mean.size() == 0) return std::nullopt;
    if (is_vector(term.form) || term.form == SourceForm::frame) {
        const Vec3 v = term.mean.head<3>();
        const Vec3 along = v.norm() > 0 ? Vec3(v.normalized()) : Vec3(Vec3::UnitX());
        return Magnitude{v.norm(), std::sqrt(along.dot(term.covariance.topLeftCorner<3, 3>() * along)),
                         is_vector(term.form) && term.form != SourceForm::marker ? "N" : "mm"};
    }
    Magnitude result{term.mean[0], term.sd[0]};
    if (term.form == SourceForm::gains) {
        Eigen::Index most = 0;
        result.value = term.mean.cwiseAbs().maxCoeff(&most);
        result.sd = term.sd[most];
    }
    if (term.form == SourceForm::softening) result.unit = "ln";
    if (term.form == SourceForm::support) result.unit = "mm/N";
    if (term.form == SourceForm::normal) result.unit = term.law == SourceLaw::spring ? "N/mm" : "N";
    return result;
}

std::string MissingSource::sentence() const {
    const SourceTerm& term = likeliest();
    const std::string law = law_in_words(term), place = place_in_words(*this, term);
    const double value = term.mean.size() > 0 ? term.mean[0] : 0, sd = term.mean.size() > 0 ? term.sd[0] : 0;
    switch (term.form) {
        case SourceForm::force:
            return fmt::format("A force of {} acts within the material, {}, {}.", vector_in_short(*this, term, "N"),
                               place, law);
        case SourceForm::growth:
            return fmt::format("The material has {} by {} % in every free length, {}, {}.",
                               value > 0 ? "grown" : "shrunk", with_sd(100 * std::abs(value), 100 * sd), place, law);
        case SourceForm::softening: {
            const bool is_everywhere = term.law == SourceLaw::constant;
            // A model to first order in the logarithm of the stiffness says that it changes by more, not by how much.
            const double told = std::log(5.0);
            if (std::abs(value) > told) {
                return fmt::format("The material is {} by more than five times, as a first-order model has it, {}{}.",
                                   value > 0 ? "stiffer" : "softer", place, is_everywhere ? "" : ", growing " + law);
            }
            if (term.law == SourceLaw::with_strain) {
                return fmt::format(
                    "The material becomes {} as it is strained, {}: {:.3g} times as stiff (from {:.3g} to {:.3g}) at "
                    "the mean strain of the most strained state.",
                    value > 0 ? "stiffer" : "softer", place, std::exp(value), std::exp(value - 2 * sd),
                    std::exp(value + 2 * sd));
            }
            return fmt::format("The material is {:.2g} times as stiff (from {:.2g} to {:.2g}) {}{}.", std::exp(value),
                               std::exp(value - 2 * sd), std::exp(value + 2 * sd), place,
                               is_everywhere ? "" : " at the most, growing " + law);
        }
        case SourceForm::fibres:
            return fmt::format("The material is {} along {} than across, by {} of the shear modulus, {}.",
                               value > 0 ? "stiffer" : "softer", components_in_words(term.axis),
                               with_sd(std::abs(value), sd), law);
        case SourceForm::set:
            return fmt::format(
                "The material keeps part of the shape that earlier loads gave it, as if up to {:.2g} of each still "
                "acted.",
                term.mean.sum());
        case SourceForm::traction:
            if (term.law == SourceLaw::one_sided)
                return fmt::format("Something is in the way of the surface, {}, {}: with a force of up to {}.", place,
                                   law, vector_in_short(*this, term, "N"));
            return fmt::format("A force of {} acts on the surface, {}, {}.", vector_in_short(*this, term, "N"), place,
                               law);
        case SourceForm::normal:
            if (term.law == SourceLaw::spring)
                return fmt::format("Something of {} N/mm holds the surface, {}, {}.", with_sd(value, sd), place, law);
            return fmt::format("A pressure of {} N in all presses {}, {}, {}.", with_sd(std::abs(value), sd),
                               value > 0 ? "inward" : "outward", place, law);
        case SourceForm::support:
            return fmt::format("The support moves {}: by {} mm for each newton.", law, with_sd(value, sd));
        case SourceForm::marker:
            return fmt::format("The readings of one marker are off by {}, {}.", vector_in_short(*this, term, "mm"),
                               law);
        case SourceForm::frame:
            return fmt::format(
                "All readings are off together, as if their frame had moved by ({:.2g}, {:.2g}, {:.2g}) mm and turned "
                "by "
                "{:.2g} degrees, {}.",
                term.mean[0], term.mean[1], term.mean[2], term.mean.tail<3>().norm() * 180 / M_PI, law);
        case SourceForm::gain:
            return fmt::format("The force of probe {} is {} % {} than it is told.", term.number,
                               with_sd(100 * std::abs(value), 100 * sd), value > 0 ? "larger" : "smaller");
        case SourceForm::readings:
            return fmt::format("Single readings are off by themselves, around ({:.1f}, {:.1f}, {:.1f}) mm.", at.x(),
                               at.y(), at.z());
        case SourceForm::gains:
            return fmt::format(
                "Forces of single probes differ from what is told, by {:.2g} % rms, each by a share of its own.",
                100 * std::sqrt(term.mean.squaredNorm() / static_cast<double>(term.mean.size())));
    }
    return {};
}

}  // namespace palpate::identify
