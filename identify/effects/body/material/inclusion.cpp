#include "fem/effects/material/inclusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/centre_numbers.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// Pieces of the body away from its supports; all of them where it is short.
std::vector<Vec3> free_pieces(const BodyModel& model) {
    const Points& pieces = model.pieces();
    const Points& supports = model.support_points();
    for (const double away : {0.2, 0.1, 0.0}) {  // of the size
        std::vector<Vec3> free;
        for (Eigen::Index p = 0; p < pieces.rows(); ++p) {
            const double distance = (supports.rowwise() - pieces.row(p)).rowwise().norm().minCoeff();
            if (distance >= away * model.size()) free.emplace_back(pieces.row(p));
        }
        if (!free.empty()) return free;
    }
    return {};
}

/// The longest side of a stout body, less of one that is thin [mm].
double stout_size(const SamplingContext& context) {
    const double size = context.model.size();
    const double volume = std::abs(mesh::signed_volume(context.set.rest_surface));
    return volume > 0 ? std::min(size, 1.5 * std::cbrt(volume)) : size;
}

/// A ball within the body that is stiffer, or softer, than the rest.
class InclusionEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "inclusion",
            .kind = EffectKind::body,
            .meaning = "Somewhere in the body the material is stiffer or softer than elsewhere.",
            .parameters = {"cx, cy, cz [mm]: its centre", "radius [mm]: of a ball that stands for it",
                           "ratio [-]: its stiffness over that of the rest"},
            .reveals = "an error in proportion to the load, large for some probes and absent for others",
            .confused_with = {"anisotropy", "outliers"},
            .separating_probe = "press astride the supposed place",
            .next_probe = "load"};
        return text;
    }

    bool is_like_mesh_error() const override { return true; }
    bool may_repeat() const override { return true; }
    bool lie_apart(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const override {
        return (one.head<3>() - other.head<3>()).norm() > std::exp(one[3]) + std::exp(other[3]);
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        std::vector<EffectNumber> result = centre_numbers(model);
        const double radius = std::log(0.12 * model.size());
        result.push_back({.name = "radius",
                          .unit = "mm",
                          .start = radius,
                          .prior_mean = radius,
                          .prior_sd = 0.5,
                          .logarithm = true});
        result.push_back({.name = "ratio", .unit = "1", .prior_sd = 1.5, .logarithm = true});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.material.push_back(std::make_shared<fem::Inclusion>(
            fem::Inclusion::sphere(values.head<3>(), std::exp(values[3]), std::exp(values[4]))));
        return true;
    }

    std::optional<ScreenedNumber> screened_number() const override {
        return ScreenedNumber{.name = "ratio", .unit = "1", .value = [](double ln) { return std::exp(std::abs(ln)); }};
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem&, const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        const Places places(model);
        const ModelSetting setting = explanation.setting();
        ScreenPlan plan;
        plan.signatures = {places.weights.cols(),
                           [&model, &forward, setting, W = places.weights](int k, const Eigen::VectorXd& q) {
                               Signatures::InAction result;
                               result.forces = model.piece_force(q, setting, forward.actions[k], W);
                               for (int c = 0; c < W.cols(); ++c) result.columns.push_back(c);
                               return result;
                           }};
        plan.columns = [](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 1.0)};
        };
        plan.start = [balls = places.balls](Eigen::Index place, const Eigen::VectorXd& ratio) {
            Eigen::VectorXd start(5);
            start << balls[place].centre, std::log(balls[place].radius), std::clamp(ratio[0], -1.0, 1.0);
            return start;
        };
        return plan;
    }

    std::string objection(const Problem& problem, const Eigen::VectorXd& values) const override {
        if (problem.markers < 2) return {};  // how large the body is shows in where its markers are
        const auto& markers = problem.rest.topRows(problem.markers);
        const Eigen::RowVector3d extent = markers.colwise().maxCoeff() - markers.colwise().minCoeff();
        const double radius = std::exp(values[3]);
        if (2 * radius <= extent.maxCoeff()) return {};
        return fmt::format(
            "its ball, of radius {:.3g} mm, is larger than the body: stiffness varies from one end of it to the other",
            radius);
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        constexpr double together = 0.8;  // correlation: either would be known to 0.6 of its sd, were the other given
        constexpr std::size_t radius = 3, ratio = 4;
        const auto& p = record.parameters;
        std::string text = fmt::format(
            "Something {} lies in the body around ({}, {}, {}) mm, with a radius of {} mm, {} times as stiff as "
            "elsewhere",
            p[ratio].value > 1 ? "hard" : "soft", number_in_words(record, 0, covariance),
            number_in_words(record, 1, covariance), number_in_words(record, 2, covariance),
            number_in_words(record, radius, covariance), number_in_words(record, ratio, covariance));
        if (covariance.size() > 0 && std::abs(covariance(radius, ratio)) >
                                         together * std::sqrt(covariance(radius, radius) * covariance(ratio, ratio)))
            text += "; its radius and its stiffness are known together only";
        return text + ".";
    }

    std::optional<std::uint64_t> stream() const override { return 11; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        constexpr int places = 3;  // that are tried, until it can be felt
        const double size = stout_size(context);
        const std::vector<Vec3> pieces = free_pieces(context.model);
        const double ratio = specified.value("ratio", context.random.uniform() < 0.5 ? 8.0 : 1 / 8.0);
        const bool is_specified = specified.has_any({"radius", "hx", "hy", "hz"});
        std::vector<EffectSampler> samplers;
        for (int place = 0; place < places; ++place) {
            const auto piece = static_cast<std::size_t>(context.random.uniform() * static_cast<double>(pieces.size()));
            const Vec3 centre = specified.vector({"cx", "cy", "cz"}, pieces[piece]);
            const auto at = [=](double x) {
                std::vector<std::pair<std::string, double>> values{
                    {"cx", centre.x()}, {"cy", centre.y()}, {"cz", centre.z()}, {"ratio", ratio}};
                if (!is_specified) values.emplace_back("radius", (0.1 + 0.15 * x) * size);
                return specified.effect(values);
            };
            samplers.push_back({.at = at, .start = 0.3, .most = 1, .is_specified = is_specified, .is_local = true});
        }
        if (specified.has_any({"cx", "cy", "cz"}) || is_specified) samplers.resize(1);
        return samplers;
    }

private:
    struct Ball {
        Vec3 centre;
        double radius;
    };

    /// Balls to be tried, spread over the body, and the pieces in each.
    struct Places {
        std::vector<Ball> balls;
        Eigen::MatrixXd weights;  // (pieces x balls)

        explicit Places(const BodyModel& model) {
            const Points& pieces = model.pieces();
            const auto count = static_cast<double>(pieces.rows());
            std::vector<Eigen::VectorXd> columns;
            for (const double share : {0.07, 0.11, 0.17, 0.25}) {  // of the size
                const double radius = share * model.size();
                for (const int at : mesh::farthest_points(pieces, 80)) {
                    const Vec3 centre = pieces.row(at);
                    const Eigen::ArrayXd d = (pieces.rowwise() - centre.transpose()).rowwise().norm() / radius;
                    const Eigen::VectorXd inside = ((1.15 - d) / 0.3).min(1.0).max(0.0);
                    constexpr double most = 0.6;  // of the body: more is the body itself
                    if (inside.sum() > most * count) continue;
                    balls.push_back({centre, radius});
                    columns.push_back(inside);
                }
            }
            weights.resize(pieces.rows(), std::ssize(columns));
            for (std::size_t c = 0; c < columns.size(); ++c) weights.col(static_cast<Eigen::Index>(c)) = columns[c];
        }
    };
};

}  // namespace

std::shared_ptr<const EffectHypothesis> inclusion_effect() { return std::make_shared<InclusionEffect>(); }

}  // namespace palpate::identify
