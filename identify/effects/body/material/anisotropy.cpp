#include "fem/effects/material/anisotropy.h"

#include <fmt/format.h>
#include <Eigen/LU>

#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/geometry/sampling.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// n directions spread evenly over a half of the sphere (n x 3), by Fibonacci's spiral.
Points half_sphere(int n) {
    constexpr double golden = 2.399963229728653;  // angle [rad]
    Points result(n, 3);
    for (int i = 0; i < n; ++i) {
        const double z = (i + 0.5) / n, r = std::sqrt(1 - z * z);
        result.row(i) << r * std::cos(golden * i), r * std::sin(golden * i), z;
    }
    return result;
}

/// The 15 products of four components of each direction (n x 15).
Eigen::MatrixXd fourth_powers(const Points& n) {
    Eigen::MatrixXd result(n.rows(), 15);
    int column = 0;
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) {
            for (int c = b; c < 3; ++c) {
                for (int d = c; d < 3; ++d) {
                    result.col(column++) = n.col(a).array() * n.col(b).array() * n.col(c).array() * n.col(d).array();
                }
            }
        }
    }
    return result;
}

/// Fibres along one direction, all through the body: transverse isotropy.
class AnisotropyEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "anisotropy",
            .kind = EffectKind::body,
            .meaning = "The material is stiffer, or softer, along one direction: fibres run through all of it.",
            .parameters = {"k [-]: modulus of the fibres over the shear modulus; 3 makes it about twice as stiff along "
                           "them",
                           "nx, ny, nz [-]: their direction"},
            .reveals = "an error in proportion to the load that depends on the direction of the strain",
            .confused_with = {"inclusion", "force-gain", "volume"},
            .separating_probe = "load along, across and between the supposed fibres",
            .next_probe = "load"};
        return text;
    }

    bool is_like_mesh_error() const override { return true; }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        std::vector<EffectNumber> result{{.name = "k", .unit = "1", .prior_sd = 4}};
        for (const char* axis : {"nx", "ny", "nz"}) {
            result.push_back({.name = axis, .unit = "1", .start = 1, .prior_sd = 1, .prior_at_start = true});
        }
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.material.push_back(fibres(values[0], values.tail<3>().normalized()));
        return true;
    }

    std::optional<ScreenedNumber> screened_number() const override {
        return ScreenedNumber{.name = "k", .unit = "1", .value = [](double k) { return std::abs(k); }};
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem&, const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // The fibres' force is linear in the products of four components of their direction, 15 in all: as many
        // directions tell it for any other.
        constexpr int products = 15, directions = 150;
        const Points basis = half_sphere(products), all = half_sphere(directions);
        const Eigen::MatrixXd from_basis =
            fourth_powers(basis).transpose().fullPivLu().solve(fourth_powers(all).transpose());  // (15 x directions)
        const ModelSetting setting = explanation.setting();
        ScreenPlan plan;
        plan.signatures = {products, [&model, &forward, setting, basis](int k, const Eigen::VectorXd& q) {
                               Signatures::InAction result;
                               result.forces.resize(model.dofs(), products);
                               const Eigen::VectorXd without = model.residual(q, setting, forward.actions[k]);
                               for (int b = 0; b < products; ++b) {
                                   ModelSetting with = setting;
                                   with.effects.material.push_back(fibres(1, basis.row(b).transpose()));
                                   result.forces.col(b) = model.residual(q, with, forward.actions[k]) - without;
                                   result.columns.push_back(b);
                               }
                               return result;
                           }};
        plan.columns = [from_basis](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities * from_basis, Eigen::VectorXd::Constant(1, 3.0)};
        };
        plan.start = [all](Eigen::Index direction, const Eigen::VectorXd& k) {
            Eigen::Vector4d start;
            start << std::clamp(k[0], -0.5, 3.0), all.row(direction).transpose();
            return start;
        };
        return plan;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& values) const override {
        Eigen::VectorXd of_unit = values;
        of_unit.tail<3>().normalize();
        return EffectHypothesis::record(numbers, of_unit);
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto& p = record.parameters;
        constexpr double young_over_shear = 2.9;  // at nu = .45
        const double sd = covariance.size() > 0 ? std::sqrt(std::max(covariance(0, 0), 0.0)) : 0;
        return fmt::format("The material is {} times as stiff along {} as across.",
                           mesh::with_sd(1 + p[0].value / young_over_shear, sd / young_over_shear),
                           components_in_words({p[1].value, p[2].value, p[3].value}));
    }

    std::optional<std::uint64_t> stream() const override { return 8; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        constexpr int directions = 3;  // that are tried: fibres across a beam hardly show
        std::vector<EffectSampler> samplers;
        for (int i = 0; i < directions; ++i) {
            const Vec3 n = specified.vector({"nx", "ny", "nz"}, random_direction(context.random));
            const auto at = [=](double x) {
                return specified.effect({{"k", x}, {"nx", n.x()}, {"ny", n.y()}, {"nz", n.z()}});
            };
            samplers.push_back({.at = at, .start = 3, .most = 15, .is_specified = specified.has("k")});
        }
        if (specified.has_any({"nx", "ny", "nz"})) samplers.resize(1);
        return samplers;
    }

private:
    static std::shared_ptr<const fem::MaterialEffect> fibres(double k, const Vec3& n) {
        return std::make_shared<fem::Anisotropy>(std::vector<fem::Fibre>{{k, n}});
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> anisotropy_effect() { return std::make_shared<AnisotropyEffect>(); }

}  // namespace palpate::identify
