#include "identify/diagnosis/likelihood/reading_weights.h"

#include <algorithm>
#include <cmath>

#include "fem/effects/point/point_potential.h"
#include "identify/diagnosis/likelihood/tool_prints.h"

namespace palpate::identify {
namespace {

double squared_distance(const Points& points, const Vec3& x, Eigen::Index& nearest) {
    return (points.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
}

/// How closely each marker lies to what is held.
class Border {
public:
    Border(const BodyModel& model, const Points& markers) {
        const Points& support = model.support_points();
        double sum = 0;
        int count = 0;
        for (Eigen::Index p = 0; p < model.pieces().rows() && support.rows() > 0; ++p) {
            if (!model.pieces_at_support()[static_cast<std::size_t>(p)]) continue;
            Eigen::Index nearest = 0;
            sum += std::sqrt(squared_distance(support, model.pieces().row(p), nearest));
            ++count;
        }
        closeness_ = Eigen::VectorXd::Zero(markers.rows());
        skin_.assign(static_cast<std::size_t>(markers.rows()), 0);
        if (!(sum > 0)) return;
        const double reach = 2 * sum / count;
        for (Eigen::Index m = 0; m < markers.rows(); ++m) {
            Eigen::Index held = 0;
            closeness_[m] = std::exp(-squared_distance(support, markers.row(m), held) / (reach * reach));
            squared_distance(model.skin(), support.row(held), skin_[static_cast<std::size_t>(m)]);
        }
    }

    double closeness(int marker) const { return closeness_[marker]; }  // 1: on the support, 0: far from it
    Eigen::Index skin_point(int marker) const { return skin_[static_cast<std::size_t>(marker)]; }  // held next to it

private:
    Eigen::VectorXd closeness_;
    std::vector<Eigen::Index> skin_;
};

/// An indentation, of which a share is unknown.
struct Dent {
    mesh::Contact contact;
    double unknown = 0;
};

/// What walls press into the skin (s x 3), a dent for each of its points that they touch.
void add_walls(const BodyModel& model, const ModelSetting& setting, const Points& skin, double unknown,
               std::vector<Dent>& dents) {
    if (skin.rows() == 0) return;
    for (const auto& potential : setting.effects.points) {
        if (!potential->is_one_sided() || potential->acts_on() != fem::ActsOn::surface) continue;
        const Eigen::VectorXd areas = potential->weights(model.skin(), model.skin_areas());
        const double none = 1e-6 * areas.maxCoeff();  // what rounding makes of the corners of quadratic faces
        for (Eigen::Index s = 0; s < skin.rows(); ++s) {
            if (areas[s] <= none) continue;
            const Vec3 rest = model.skin().row(s);
            const Vec3 force = -areas[s] * potential->terms(rest, skin.row(s)).gradient;
            if (!force.isZero(0))
                dents.push_back({{.point = rest, .force = force, .radius = std::sqrt(areas[s] / M_PI)}, unknown});
        }
    }
}

/// Dents in each action: of its contacts, of tools and walls, and where the body yields, the strongest at each place
/// before. `skin`: where it stands in each action.
std::vector<std::vector<Dent>> dents_of(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                                        const ForwardSolution& forward, const std::vector<Points>& skin, bool yields,
                                        const NuisanceOptions& options) {
    std::vector<std::vector<Dent>> dents(forward.actions.size());
    for (int k = 0; k < static_cast<int>(forward.actions.size()); ++k) {
        for (const mesh::Contact& contact : forward.actions[k].contacts) dents[k].push_back({contact, options.dent});
        for (const ToolPrint& print : tool_prints(model, problem, setting, forward, k))
            dents[k].push_back({print.contact, options.dent});
        add_walls(model, setting, skin[k], options.wall_dent, dents[k]);
        if (!yields || problem.before(k) < 0) continue;
        for (const Dent& earlier : dents[problem.before(k)]) {
            const auto same =
                std::ranges::find(dents[k], earlier.contact.point, [](const Dent& dent) { return dent.contact.point; });
            if (same == dents[k].end()) {
                dents[k].push_back(earlier);
            } else if (earlier.contact.force.norm() > same->contact.force.norm()) {
                *same = earlier;
            }
        }
    }
    return dents;
}

/// What an even pressure, over Young's modulus, indents a half-space by plastic flow, over what it does elastically:
/// it yields first, by Tresca's criterion, where the largest shear is a third of the pressure [Johnson, Contact
/// mechanics, 3.4], and beyond that gives way as much more as its hardening is below its elastic stiffness.
double plastic_indentation(const fem::Plasticity& plasticity, double pressure) {
    constexpr double least_hardening = 0.01;  // what flows is confined by the elastic body round it
    const double first = 1.5 * plasticity.yield;
    return std::max(0.0, pressure / first - 1) / std::max(plasticity.hardening, least_hardening);
}

}  // namespace

Eigen::VectorXd reading_weights(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                                const ForwardSolution& forward, const NuisanceOptions& options) {
    const ModelSetting setting = explanation.setting();
    const double E = model.young(setting);
    constexpr double nu = 0.45;
    const double flow = setting.effects.plasticity ? options.flow : 0;
    const Border border(model, problem.rest.topRows(problem.markers));
    std::vector<Points> skin;  // where it stands in each action
    for (const Eigen::VectorXd& q : forward.q) skin.push_back(model.skin_positions(q, setting));
    const std::vector<std::vector<Dent>> dents =
        dents_of(model, problem, setting, forward, skin, problem.by_stage && flow > 0, options);
    Eigen::VectorXd variance = Eigen::VectorXd::Ones(problem.rows());  // in sigma^2
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (!problem.is_position(n)) continue;
        const int marker = problem.channel(n);
        const Vec3 moved = forward.channels[problem.action[n]].row(marker) - problem.rest.row(marker);
        const Eigen::Index held = border.skin_point(marker);
        const Vec3 base = skin[problem.action[n]].row(held) - model.skin().row(held);
        variance[n] += std::pow(flow * moved.norm() / problem.sigma[n], 2);
        variance[n] +=
            std::pow(options.ragged * border.closeness(marker) * (moved - base).norm() / problem.sigma[n], 2);
        for (const auto& [contact, unknown] : dents[problem.action[n]]) {
            const double r = effective_radius(model, contact), F = contact.force.norm();
            const double d = (problem.rest.row(marker).transpose() - contact.point).norm();
            double U = F * (1 - nu * nu) / (2 * E * r);
            const double p = F / (M_PI * r * r);
            if (model.is_nonlinear(setting)) U *= 1 + p / E;
            if (setting.effects.plasticity) U *= 1 + plastic_indentation(*setting.effects.plasticity, p / E);
            const double near = std::min(1.0, std::pow(1.2 * r / std::max(d, 1e-9), 2));
            variance[n] += std::pow(unknown * U * near / problem.sigma[n], 2);
        }
    }
    return variance.cwiseSqrt().cwiseInverse();
}

}  // namespace palpate::identify
