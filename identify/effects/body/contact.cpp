#include "fem/effects/point/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/effects/plane_scan.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Where a plane would be in the way.
struct Side {
    Vec3 towards;         // of unit length
    double reach = 0;     // of the body at rest along it [mm]
    double furthest = 0;  // how far a probe pushes the body beyond that, at most [mm]
    double pushed = 0;    // the same, rms over the rows [mm]
};

Side side_of(const SamplingContext& context, const Vec3& direction) {
    Side side{.towards = direction.normalized()};
    side.reach = (context.model.skin() * side.towards).maxCoeff();
    int rows = 0;
    for (const std::vector<Eigen::VectorXd>& path : context.baseline) {
        for (const Eigen::VectorXd& q : path) {
            const Points there = context.model.skin_positions(q, context.setting);
            const double beyond = std::max(0.0, (there * side.towards).maxCoeff() - side.reach);
            side.furthest = std::max(side.furthest, beyond);
            side.pushed += beyond * beyond;
            ++rows;
        }
    }
    side.pushed = std::sqrt(side.pushed / rows);
    return side;
}

/// The sides that the probes push the body to most, of 26 round it.
std::vector<Side> sides_in_the_way(const SamplingContext& context, int count) {
    std::vector<Side> sides;
    for (const int z : {-1, 0, 1}) {
        for (const int y : {-1, 0, 1}) {
            for (const int x : {-1, 0, 1}) {
                if (x != 0 || y != 0 || z != 0) sides.push_back(side_of(context, Vec3(x, y, z)));
            }
        }
    }
    std::ranges::stable_sort(sides, std::greater<>(), &Side::pushed);
    sides.resize(static_cast<std::size_t>(count));
    return sides;
}

/// A plane that the body meets when it moves: it pushes back there, and never pulls.
class ContactEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "contact",
            .kind = EffectKind::body,
            .meaning = "The body meets an unreported flat obstacle: a table, a wall, the floor of the rig.",
            .parameters = {"nx, ny, nz [-]: normal of the plane, to where the body is",
                           "offset [mm]: of the plane along it", "stiffness [N/mm^3]: pressure over depth"},
            .reveals = "markers that stop at a plane under some probes, and are right under the opposite ones",
            .confused_with = {"stiffening", "compliant-support"},
            .separating_probe = "reverse the force: pulled away from the plane the error is gone",
            .next_probe = "load"};
        return text;
    }

    bool is_like_mesh_error() const override { return true; }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        if (model.skin().rows() == 0) return {};
        std::vector<EffectNumber> result;
        constexpr double tilt = 0.5;  // a choice: the directions of a scan are 0.6 to 0.8 apart
        for (const char* axis : {"nx", "ny", "nz"}) {
            result.push_back({.name = axis, .unit = "1", .prior_sd = tilt, .prior_at_start = true});
        }
        // Offsets are told at the origin: a plane that turns about the place where it is met moves there, the further
        // that place is away.
        const double furthest = model.skin().rowwise().norm().maxCoeff();
        result.push_back({.name = "offset",
                          .unit = "mm",
                          .prior_sd = std::hypot(0.05 * model.size(), tilt * furthest),
                          .prior_at_start = true});
        const double hard = std::log(hardness(model));
        result.push_back({.name = "stiffness",
                          .unit = "N/mm^3",
                          .start = hard,
                          .prior_mean = hard,
                          .prior_sd = 1,
                          .logarithm = true,
                          .least = hard + std::log(softest)});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<fem::ContactPlane>(values.head<3>().normalized(), values[3], std::exp(values[4])));
        return true;
    }

    std::optional<ScreenedNumber> screened_number() const override { return ScreenedNumber{}; }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        const auto scan = std::make_shared<PlaneScan>(model, problem, explanation.setting(), forward);
        const ModelSetting setting = explanation.setting();
        ScreenPlan plan;
        plan.signatures = {scan->width(), [&model, scan, setting](int k, const Eigen::VectorXd& q) {
                               Signatures::InAction result;
                               if (scan->width() == 0) return result;
                               result.forces = model.skin_motion(q, setting).transpose() * scan->pressures();
                               for (int c = 0; c < scan->width(); ++c) result.columns.push_back(c);
                               result.combine = [scan, k, forces = result.forces](const Eigen::MatrixXd& steps) {
                                   return scan->pushed_back(k, forces, steps);
                               };
                               return result;
                           }};
        plan.columns = [](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 1.0), true};
        };
        const double hard = std::log(hardness(model));
        plan.place = [scan](Eigen::Index plane) { return scan->planes()[plane].direction; };
        // Less of a plane is a softer one: a hard one a little too near does more harm than none.
        plan.start = [scan, hard](Eigen::Index plane, const Eigen::VectorXd& screened) {
            Eigen::VectorXd start(5);
            const double softer = std::log(std::clamp(screened[0] * screened[0], softest, 1.0));
            start << scan->planes()[plane].normal, scan->planes()[plane].offset, hard + softer;
            return start;
        };
        return plan;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& values) const override {
        Eigen::VectorXd of_unit = values;
        of_unit.head<3>().normalize();
        return EffectHypothesis::record(numbers, of_unit);
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto& p = record.parameters;
        return fmt::format("The body meets a plane with normal {} at {} mm along it.",
                           components_in_words({p[0].value, p[1].value, p[2].value}),
                           number_in_words(record, 3, covariance));
    }

    std::optional<std::uint64_t> stream() const override { return 12; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (context.model.skin().rows() == 0) throw InvalidInput("effect 'contact' needs a skin, the model has none");
        if (context.is_skeleton() && context.in_small_strain()) {
            throw InvalidInput(
                "effect 'contact' is one-sided, which a skeleton's linear law cannot be; leave --linear out");
        }
        // One of the six sides that are pushed to most; then the others.
        constexpr int places = 3;  // that are tried, until it can be felt
        std::vector<Side> sides = sides_in_the_way(context, 6);
        const auto first = static_cast<std::size_t>(context.random.uniform() * static_cast<double>(sides.size()));
        std::swap(sides[0], sides[first]);
        sides.resize(places);
        if (specified.has_any({"nx", "ny", "nz"})) {
            const Vec3 n = specified.vector({"nx", "ny", "nz"}, Vec3::Zero());
            if (n.isZero(0))
                throw InvalidInput("effect 'contact': the normal (nx, ny, nz) is zero; it needs a direction");
            sides = {side_of(context, -n)};
        }
        // Stiff against the body: pressed by E/20 it gives way by 0.05 % of the size.
        const double stiffness = 100 * context.stiffness / context.model.size();
        std::vector<EffectSampler> samplers;
        for (const Side& side : sides) {
            const auto at = [=](double x) {
                const double gap = (1 - x) * side.furthest;
                const Vec3 n = -side.towards;
                return specified.effect({{"nx", n.x()},
                                         {"ny", n.y()},
                                         {"nz", n.z()},
                                         {"offset", -(side.reach + gap)},
                                         {"stiffness", stiffness}});
            };
            samplers.push_back(
                {.at = at, .start = 0.6, .most = 1, .is_specified = specified.has("offset"), .is_local = true});
        }
        return samplers;
    }

private:
    // of `hardness`: twice E over the body's size. What yields more than the body does is no wall.
    static constexpr double softest = 0.01;

    /// A plane next to which the body is soft [N/mm^3].
    static double hardness(const BodyModel& model) {
        Eigen::VectorXd theta(std::ssize(model.parameters()));
        for (Eigen::Index p = 0; p < theta.size(); ++p) theta[p] = model.parameters()[p].start;
        constexpr double share = 0.005;  // of the size, that a pressure of Young's modulus presses in
        return model.young({.law = 0, .theta = theta, .effects = {}}) / (share * model.size());
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> contact_effect() { return std::make_shared<ContactEffect>(); }

}  // namespace palpate::identify
