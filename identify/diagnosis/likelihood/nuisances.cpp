#include "identify/diagnosis/likelihood/nuisances.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "identify/diagnosis/likelihood/tool_nuisances.h"
#include "identify/diagnosis/likelihood/tool_prints.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// Collects nuisances: names and precisions once, forces action by action.
class Collector {
public:
    /// Columns known in one action only.
    struct Own {
        int action;
        std::function<Eigen::MatrixXd(const Eigen::VectorXd& q)> forces;  // (dofs x c)
        std::vector<int> columns;
    };

    /// The number of a nuisance, which actions may share.
    int add(const std::string& name, double sd) {
        const auto found = std::ranges::find(names, name);
        if (found != names.end()) return static_cast<int>(found - names.begin());
        names.push_back(name);
        precisions.push_back(1 / (sd * sd));
        return static_cast<int>(names.size()) - 1;
    }

    std::vector<std::string> names;
    std::vector<double> precisions;
    std::vector<Own> own;
};

/// How near the middle of a contact may be to a support before most of the force goes straight into it [radii].
constexpr double next_to_support = 1.2;

double distance_to_support(const BodyModel& model, const Vec3& point) {
    if (model.support_points().rows() == 0) return INFINITY;
    return (model.support_points().rowwise() - point.transpose()).rowwise().norm().minCoeff();
}

void add_contact(Collector& all, const BodyModel& model, const ModelSetting& setting, int k, const Action& action,
                 const mesh::Contact& contact, const NuisanceOptions& options) {
    const double r = effective_radius(model, contact);
    const Vec3 normal = model.normal_near(contact.point, 1.2 * r), a = normal.unitOrthogonal(), b = normal.cross(a);
    // However loads are numbered: what touches a place with the same tip does so in one way.
    const std::string where = fmt::format("of radius {:.4g} mm at ({:.4g}, {:.4g}, {:.4g})", r, contact.point.x(),
                                          contact.point.y(), contact.point.z());

    // Shifts and radius, each a difference over the radius.
    std::vector<int> columns{all.add("contact " + where + " shifted", options.shift),
                             all.add("contact " + where + " shifted across", options.shift),
                             all.add("radius of the contact " + where, options.radius)};
    all.own.push_back({k,
                       [&model, setting, contact, r, a, b](const Eigen::VectorXd& q) {
                           const auto force = [&](const Vec3& shift, double scale) {
                               mesh::Contact moved = contact;
                               moved.point += shift;
                               moved.radius = scale * r;
                               return model.contact_force(q, setting, moved);
                           };
                           const double h = 0.35;
                           Eigen::MatrixXd G(model.dofs(), 3);
                           G.col(0) = (force(h * r * a, 1) - force(-h * r * a, 1)) / (2 * h);
                           G.col(1) = (force(h * r * b, 1) - force(-h * r * b, 1)) / (2 * h);
                           G.col(2) = (force(Vec3::Zero(), 1.3) - force(Vec3::Zero(), 0.75)) / 0.55;
                           return G;
                       },
                       columns});

    // Softness within two radii, fading out from one.
    const Points& centres = model.pieces();
    Eigen::VectorXd distance = (centres.rowwise() - contact.point.transpose()).rowwise().norm() / r;
    Eigen::VectorXd weight = (2 - distance.array()).min(1.0).max(0.0);
    Eigen::Index nearest = 0;
    distance.minCoeff(&nearest);
    weight[nearest] = 1;
    all.own.push_back({k,
                       [&model, setting, action, weight](const Eigen::VectorXd& q) {
                           return model.piece_force(q, setting, action, weight);
                       },
                       {all.add("softness round the contact " + where, options.softness)}});

    if (distance_to_support(model, contact.point) < next_to_support * r) {
        all.own.push_back({k,
                           [&model, setting, contact](const Eigen::VectorXd& q) -> Eigen::MatrixXd {
                               return model.contact_force(q, setting, contact);
                           },
                           {all.add("gain next to the support, of the contact " + where, options.gain_at_support)}});
    }
}

/// Sectors of the pieces that supports cut, as weights (p x sectors).
Eigen::MatrixXd clamp_sectors(const BodyModel& model, int most) {
    const std::vector<char>& cut = model.pieces_at_support();
    std::vector<int> ids;
    for (std::size_t p = 0; p < cut.size(); ++p) {
        if (cut[p]) ids.push_back(static_cast<int>(p));
    }
    const Points centres = model.pieces()(ids, Eigen::all);
    const std::vector<int> seeds = mesh::farthest_points(centres, most);
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(std::ssize(cut), std::ssize(seeds));
    for (std::size_t i = 0; i < ids.size(); ++i) {
        W(ids[i], mesh::nearest_seed(centres, seeds, static_cast<Eigen::Index>(i))) = 1;
    }
    return W;
}

/// Adds nuisances of one prior sd; columns over sigma (N x c).
void add(const std::vector<std::string>& names, const Eigen::MatrixXd& columns, double sd, Nuisances& nuisances) {
    const Eigen::Index more = columns.cols();
    nuisances.columns.conservativeResize(Eigen::NoChange, nuisances.columns.cols() + more);
    nuisances.columns.rightCols(more) = columns;
    nuisances.precisions.conservativeResize(nuisances.precisions.size() + more);
    nuisances.precisions.tail(more).setConstant(1 / (sd * sd));
    nuisances.names.insert(nuisances.names.end(), names.begin(), names.end());
}

/// What a tool feels next to a support: each time by a gain of its own.
void add_gains_at_support(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                          const ForwardSolution& forward, double gain, Nuisances& result) {
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) {
        for (const ToolPrint& print : tool_prints(model, problem, setting, forward, k)) {
            if (distance_to_support(model, print.contact.point) > next_to_support * print.contact.radius) continue;
            const int tool = forward.actions[k].motions[print.motion].tool, force = problem.markers + 2 * tool;
            Eigen::VectorXd column = Eigen::VectorXd::Zero(problem.rows());
            for (Eigen::Index n = 0; n < problem.rows(); ++n) {
                const int channel = problem.channel(n);
                if (problem.action[n] == k && (channel == force || channel == force + 1))
                    column[n] = forward.channels[k](channel, problem.coordinate[n] % 3) / problem.sigma[n];
            }
            add({fmt::format("gain next to the support, of the tool '{}' in probe {}", problem.rig->tools[tool].name,
                             problem.probe[k])},
                column, gain, result);
        }
    }
}

/// What was taken off for the mesh, more or less of it: alike in all actions, but for those in which tools that may
/// part touch, each somewhere else, with a few elements.
void add_errors_of_mesh(const BodyModel& model, const Problem& problem, double share, Nuisances& result) {
    if (problem.discretisation.size() == 0) return;
    std::vector<std::optional<double>> left;  // of each action's own
    for (const Action& action : problem.actions) left.push_back(model.remaining_mesh_error(action));
    std::map<int, Eigen::VectorXd> columns;  // of actions that have their own; -1: of all others
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (problem.discretisation[n] == 0) continue;
        const auto [column, is_new] = columns.try_emplace(left[problem.action[n]] ? problem.action[n] : -1);
        if (is_new) column->second.setZero(problem.rows());
        column->second[n] = problem.discretisation[n] / problem.sigma[n];
    }
    for (const auto& [k, column] : columns) {
        if (k < 0)
            add({"error of the mesh"}, column, share, result);
        else
            add({fmt::format("error of the mesh under a tool in probe {}", problem.probe[k])}, column, *left[k],
                result);
    }
    result.of_mesh = std::ssize(columns);
}

}  // namespace

double effective_radius(const BodyModel& model, const mesh::Contact& contact) {
    return std::max(contact.radius, 0.01 * model.size());
}

Nuisances make_nuisances(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                         const ForwardSolution& forward, int threads, const NuisanceOptions& options) {
    const ModelSetting setting = explanation.setting();
    Collector all;
    for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) {
        for (const mesh::Contact& contact : forward.actions[k].contacts) {
            add_contact(all, model, setting, k, forward.actions[k], contact, options);
        }
    }
    const Eigen::MatrixXd sectors = clamp_sectors(model, options.clamp_sectors);
    std::vector<int> sector_columns;
    for (Eigen::Index s = 0; s < sectors.cols(); ++s) {
        sector_columns.push_back(all.add(fmt::format("sector {} of the supports' border", s), options.clamp));
    }

    Signatures signatures{std::ssize(all.names), [&](int k, const Eigen::VectorXd& q) {
                              Signatures::InAction result;
                              std::vector<Eigen::MatrixXd> parts;
                              if (sectors.cols() > 0) {
                                  parts.push_back(model.piece_force(q, setting, forward.actions[k], sectors));
                                  result.columns = sector_columns;
                              }
                              for (const Collector::Own& own : all.own) {
                                  if (own.action != k) continue;
                                  parts.push_back(own.forces(q));
                                  result.columns.insert(result.columns.end(), own.columns.begin(), own.columns.end());
                              }
                              result.forces.resize(model.dofs(), std::ssize(result.columns));
                              Eigen::Index at = 0;
                              for (const Eigen::MatrixXd& part : parts) {
                                  result.forces.middleCols(at, part.cols()) = part;
                                  at += part.cols();
                              }
                              return result;
                          }};
    const ToolNuisances tools = tool_nuisances(model, problem, setting, forward);
    const std::vector<Eigen::MatrixXd> columns =
        sensitivities(model, problem, explanation, forward, {signatures, tools.signatures}, threads);
    Nuisances result{.columns = columns.front(),
                     .precisions = Eigen::Map<Eigen::VectorXd>(all.precisions.data(), std::ssize(all.precisions)),
                     .names = all.names};
    add(tools.names, columns.back(), options.play, result);
    add_gains_at_support(model, problem, setting, forward, options.gain_at_support, result);
    add_errors_of_mesh(model, problem, options.discretisation, result);
    return result;
}

}  // namespace palpate::identify
