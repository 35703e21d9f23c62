#include "fem/effects/local/stiffness_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "identify/effects/body/material/stiffness_parts.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"
#include "mesh/geometry/sampling.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

// A field finer than the readings resolve is left to its prior. Each place costs a right-hand side in every state.
constexpr int places = fem::most_places;
constexpr double most_contrast = 10;  // to hide: 10^6 between three standard deviations to either side
constexpr double fixed_sd = 1e-6;     // [mm], of places: they are where they are

/// The distance of a place to the nearest other one, in the mean.
double spacing_of(const Points& at) {
    double sum = 0;
    for (Eigen::Index i = 0; i < at.rows(); ++i) {
        double nearest = INFINITY;
        for (Eigen::Index j = 0; j < at.rows(); ++j)
            if (j != i) nearest = std::min(nearest, (at.row(i) - at.row(j)).norm());
        sum += nearest;
    }
    return sum / static_cast<double>(at.rows());
}

Points places_in(const BodyModel& model) {
    const Points& pieces = model.pieces();
    return pieces(mesh::farthest_points(pieces, places), Eigen::all);
}

/// The map of a fit's numbers, its kernels so much longer. @param more of ln length
fem::StiffnessMap map_of(const Eigen::VectorXd& values, double more = 0) {
    const Eigen::Index count = values.size() / numbers_of_map_place;
    Points at(count, 3);
    Eigen::VectorXd amplitudes(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        at.row(i) = values.segment<3>(1 + numbers_of_map_place * i).transpose();
        amplitudes[i] = values[numbers_of_map_place * (i + 1)];
    }
    return {std::move(at), std::move(amplitudes), std::exp(values[0] + more)};
}

/// Stiffness that varies over the body, wherever it does.
class StiffnessMapEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "map",
            .kind = EffectKind::body,
            .meaning = "The material is stiffer in some parts of the body and softer in others.",
            .parameters = {"length [mm]: over which stiffness varies",
                           "x1, y1, z1 [mm] and so on: places that are spread over the body, fixed",
                           "a1 [-] and so on: amplitudes of ln stiffness round them"},
            .reveals =
                "an error in proportion to the load that differs from probe to probe, in several parts of the "
                "body, where no single inclusion explains it",
            .confused_with = {"inclusion", "anisotropy", "compliant-support"},
            .separating_probe = "press at many places all over the body, and read markers all over it",
            .next_probe = "load"};
        return text;
    }

    bool is_last_resort() const override { return true; }
    bool is_like_mesh_error() const override { return true; }
    bool is_comparable(const std::string& number) const override { return number == "length"; }
    bool is_fitted(Eigen::Index number) const override { return number == 0 || is_amplitude_of_map(number); }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        const Points at = places_in(model);
        if (at.rows() < 2) return {};
        const double spacing = std::log(spacing_of(at));
        std::vector<EffectNumber> result{{.name = "length",
                                          .unit = "mm",
                                          .start = spacing,
                                          .prior_mean = spacing,
                                          .prior_sd = 0.5,
                                          .logarithm = true}};
        for (Eigen::Index i = 0; i < at.rows(); ++i) {
            for (int axis = 0; axis < 3; ++axis)
                result.push_back({.name = fmt::format("{}{}", "xyz"[axis], i + 1),
                                  .unit = "mm",
                                  .start = at(i, axis),
                                  .prior_mean = at(i, axis),
                                  .prior_sd = fixed_sd,
                                  .prior_at_start = true});
            result.push_back({.name = fmt::format("a{}", i + 1), .unit = "1"});
        }
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.material.push_back(std::make_shared<fem::StiffnessMap>(map_of(values)));
        return true;
    }

    std::optional<Eigen::MatrixXd> piece_slopes(const BodyModel& model, const Eigen::VectorXd& values) const override {
        constexpr double h = 1e-4;  // of ln length: the field is smooth in it
        // Of even pieces: a field that varies within one has other slopes. Sixteen a place are two and a half from one
        // place to the next.
        constexpr Eigen::Index least_pieces = 16;
        const fem::StiffnessMap map = map_of(values);
        if (model.pieces().rows() < least_pieces * map.places().rows()) return std::nullopt;
        const fem::StiffnessMap longer = map_of(values, h), shorter = map_of(values, -h);
        const Points& pieces = model.pieces();
        Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(pieces.rows(), values.size());
        for (Eigen::Index p = 0; p < pieces.rows(); ++p) {
            const Vec3 X = pieces.row(p);
            const Eigen::VectorXd of_amplitudes = map.centred_weights(X);
            slopes(p, 0) = (longer.log_stiffness(X) - shorter.log_stiffness(X)) / (2 * h);
            for (Eigen::Index i = 0; i < of_amplitudes.size(); ++i)
                slopes(p, numbers_of_map_place * (i + 1)) = of_amplitudes[i];
        }
        return slopes;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        constexpr std::size_t most = 4;  // parts that a sentence lists
        const std::vector<StiffnessPart> parts = StiffnessEstimate(record, covariance).parts();
        std::string text = fmt::format("Stiffness varies over the body, over lengths of about {} mm",
                                       number_in_words(record, 0, covariance));
        if (parts.empty()) return text + ", nowhere by more than is known of it.";
        text += ": ";
        for (std::size_t p = 0; p < std::min(most, parts.size()); ++p) {
            const std::string ratio = mesh::with_sd(parts[p].ratio, parts[p].sd);
            text += fmt::format("{}{} times its mean round ({:.3g}, {:.3g}, {:.3g}) mm", p == 0 ? "" : ", ",
                                parts[p].sd > 0 ? "(" + ratio + ")" : ratio, parts[p].centre.x(), parts[p].centre.y(),
                                parts[p].centre.z());
        }
        if (parts.size() > most) text += fmt::format(", and {} more", parts.size() - most);
        return text + ".";
    }

    std::optional<std::uint64_t> stream() const override { return 22; }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override {
        // Drawn with a contrast, exp of the standard deviation of ln stiffness; or the map itself.
        std::vector<skeleton::KnownParameter> result{
            fem::optional_parameter("contrast", "1", skeleton::Range::positive)};
        std::ranges::copy(fem::known_stiffness_map().parameters, std::back_inserter(result));
        return result;
    }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (specified.has("a1")) {
            const skeleton::EffectRecord whole = specified.effect({});
            skeleton::make_physics(whole);  // refuses what is incomplete
            return {{.at = [whole](double) { return whole; }, .is_specified = true, .is_local = true}};
        }
        const Points at = places_in(context.model);
        const double length = specified.value("length", spacing_of(at));
        const Eigen::VectorXd field = context.random.normals(static_cast<int>(at.rows()));
        const auto record = [=, this](double contrast) {
            skeleton::EffectRecord result{name(), {{"length", length, "mm"}}};
            for (Eigen::Index i = 0; i < at.rows(); ++i) {
                for (int axis = 0; axis < 3; ++axis)
                    result.parameters.push_back({fmt::format("{}{}", "xyz"[axis], i + 1), at(i, axis), "mm"});
                result.parameters.push_back({fmt::format("a{}", i + 1), std::log(contrast) * field[i], "1"});
            }
            return result;
        };
        // Design choice: up to a factor of 5 (1 sd). More can be specified.
        const double most = std::log(5.0);
        const double contrast = specified.value("contrast", 1);
        const bool is_specified = specified.has("contrast");
        if (is_specified && std::abs(std::log(contrast)) > std::log(most_contrast))
            throw InvalidInput(fmt::format(
                "effect 'map': a contrast of {:.4g} is outside {:.4g} to {:.4g}: stiffness would vary by more than a "
                "factor of a million over the body, three standard deviations to either side, which has no equilibrium "
                "that a solver finds. Give a smaller one, or regions of their own (--region).",
                contrast, 1 / most_contrast, most_contrast));
        return {{.at = [=](double x) { return record(is_specified ? contrast : std::exp(x)); },
                 .start = 0.3,
                 .most = most,
                 .is_specified = is_specified,
                 .is_local = true}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> stiffness_map_effect() { return std::make_shared<StiffnessMapEffect>(); }

}  // namespace palpate::identify
