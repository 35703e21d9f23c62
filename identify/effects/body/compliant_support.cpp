#include "fem/effects/point/compliant_support.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

using skeleton::skew;

/// A support that gives way, as if it stood on springs of stiffness k in all, more or less evenly over what it holds.
class CompliantSupportEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "compliant-support",
            .kind = EffectKind::body,
            .meaning = "The support is compliant: springs hold the body in place of a rigid clamp.",
            .parameters = {"stiffness [N/mm]: of all springs together",
                           "turning [-]: how stiffly it turns, over springs that are spread evenly"},
            .reveals = "the body moves and turns at its base in proportion to the force there",
            .confused_with = {"inclusion", "force-gain", "anisotropy"},
            .separating_probe = "put markers on the base and load it there",
            .next_probe = "load",
            .why_unshown = "no loaded marker tells how stiff the body is as a whole"};
        return text;
    }

    bool is_like_mesh_error() const override { return true; }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        const double k = typical_stiffness(problem);
        if (!(k > 0)) return {};
        return {{.name = "stiffness",
                 .unit = "N/mm",
                 .start = std::log(k),
                 .prior_mean = std::log(k),
                 .prior_sd = 2,
                 .logarithm = true},
                {.name = "turning", .unit = "1", .prior_sd = 0.4, .logarithm = true}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<fem::CompliantSupport>(std::exp(values[0]), std::exp(values[1])));
        return true;
    }

    std::optional<ScreenedNumber> screened_number() const override {
        return ScreenedNumber{.name = "stiffness",
                              .unit = "N/mm",
                              .value = [](double compliance) { return 1 / compliance; },
                              .at_most = true};
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // Compliance c = 1/k is neutral at 0. To first order the base moves as a rigid body by c K_1^-1 (F, M), with
        // (F, M) what the body presses on it, and K_1 that of springs of 1 N/mm in all: 1 for moving, the second
        // moment sum w (r^2 - r r^T) for turning.
        const Vec3 centre = model.support_points().transpose() * model.support_shares();
        Mat3 moment = Mat3::Zero();
        for (Eigen::Index i = 0; i < model.support_points().rows(); ++i) {
            const Mat3 arm = skew(model.support_points().row(i).transpose() - centre);
            moment -= model.support_shares()[i] * arm * arm;
        }
        moment.diagonal().array() += 1e-6 * moment.trace();
        const Eigen::MatrixXd base = model.support_motion(centre);
        const ModelSetting setting = explanation.setting();
        const double prior_sd = 0.5 / typical_stiffness(problem);  // of the compliance [mm/N]

        ScreenPlan plan;
        plan.signatures = {1, [&model, &forward, base, moment, setting](int k, const Eigen::VectorXd& q) {
                               const Action& action = forward.actions[k];
                               Eigen::VectorXd motion = base.transpose() * model.residual(q, setting, action);
                               motion.tail<3>() = moment.inverse() * motion.tail<3>();
                               const Eigen::VectorXd moved = base * motion;
                               return Signatures::InAction{.forces = -model.tangent_times(q, setting, action, moved),
                                                           .steps = moved,
                                                           .columns = {0}};
                           }};
        plan.columns = [prior_sd](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, prior_sd), true};
        };
        plan.start = [prior_sd](Eigen::Index, const Eigen::VectorXd& compliance) {
            return Eigen::Vector2d(-std::log(std::max(compliance[0], 1e-3 * prior_sd)), 0);
        };
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The support gives way: it is as stiff as springs of {} N/mm in all.",
                           number_in_words(record, 0, covariance));
    }

    std::optional<std::uint64_t> stream() const override { return 1; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        // A block of the body's size and material is about as stiff as this.
        const double block = context.stiffness * context.model.size();  // [N/mm]
        const auto at = [=](double x) { return specified.effect({{"stiffness", block / x}}); };
        return {{.at = at, .is_specified = specified.has("stiffness")}};
    }

private:
    /// Forces over displacements of the set, rms [N/mm].
    static double typical_stiffness(const Problem& problem) {
        double forces = 0;
        int loaded = 0;
        for (std::size_t k = 0; k < problem.actions.size(); ++k) {
            if (!problem.loaded(static_cast<int>(k))) continue;
            Vec3 sum = Vec3::Zero();
            for (const mesh::Contact& contact : problem.actions[k].contacts) sum += contact.force;
            forces += sum.squaredNorm();
            ++loaded;
        }
        for (Eigen::Index n = 0; n < problem.rows(); ++n) {
            const bool is_force = !problem.is_position(n) && (problem.channel(n) - problem.markers) % 2 == 0;
            if (is_force) forces += problem.measured[n] * problem.measured[n];
        }
        const double moved = problem.rms_mm(problem.displacement());
        return loaded > 0 && moved > 0 ? std::sqrt(forces / loaded) / moved : 0;
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> compliant_support_effect() {
    return std::make_shared<CompliantSupportEffect>();
}

}  // namespace palpate::identify
