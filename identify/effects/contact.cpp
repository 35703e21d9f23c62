#include "skeleton/effects/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/diagnose/fit.h"
#include "identify/effects/catalogue.h"
#include "identify/effects/plane_scan.h"

namespace palpate::identify {
namespace {

/// A plane that the body meets when it moves: it pushes back there, and never pulls.
class ContactEffect : public Effect {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "contact",
            .kind = EffectKind::body,
            .meaning = "The body meets a flat obstacle that nobody told of: a table, a wall, the floor of the rig.",
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
        for (const char* axis : {"nx", "ny", "nz"}) {
            result.push_back({.name = axis, .unit = "1", .prior_sd = 0.5, .prior_at_start = true});
        }
        result.push_back({.name = "offset", .unit = "mm", .prior_sd = 0.05 * model.size(), .prior_at_start = true});
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

    bool enforce(const Eigen::VectorXd& values, Setting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<skeleton::Contact>(values.head<3>().normalized(), values[3], std::exp(values[4])));
        return true;
    }

    ScreenPlan screen_plan(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                           const Played& played) const override {
        const auto scan = std::make_shared<PlaneScan>(model, problem, explanation.setting(), played);
        const Setting setting = explanation.setting();
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
        plan.columns = [](const Eigen::MatrixXd& answers) {
            return ScreenColumns{answers, Eigen::VectorXd::Constant(1, 1.0), true};
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

    std::string objection(const Problem&, const Eigen::VectorXd&, bool enough_without) const override {
        // A wall that hardly matters looks like what nobody knows about a probe or a clamp nearby.
        return enough_without ? "what is left without a wall is noise already" : "";
    }

    skeleton::Effect told(const std::vector<EffectNumber>& numbers, const Eigen::VectorXd& values) const override {
        Eigen::VectorXd of_unit = values;
        of_unit.head<3>().normalize();
        return Effect::told(numbers, of_unit);
    }

    std::string sentence(const skeleton::Effect& told) const override {
        const auto& p = told.parameters;
        return fmt::format("The body meets a plane with normal ({:.2f}, {:.2f}, {:.2f}) at {:.2f} mm along it.",
                           p[0].value, p[1].value, p[2].value, p[3].value);
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

std::shared_ptr<const Effect> contact_effect() { return std::make_shared<ContactEffect>(); }

}  // namespace palpate::identify
