#include "identify/diagnosis/likelihood/tool_nuisances.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "identify/diagnosis/likelihood/tool_prints.h"
#include "identify/loading/tool_motions.h"
#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

Vec3 force_on_body(const Problem& problem, const ForwardSolution& forward, std::size_t k, int tool) {
    return forward.channels[k].row(problem.markers + 2 * Eigen::Index{tool});
}

/// How a tool moves the body in an action: from where it rests, or, where it comes in touch on its way, from there.
Vec3 stroke_of(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
               const ForwardSolution& forward, int k, std::size_t motion) {
    const mesh::ToolMotion& own = forward.actions[k].motions[motion];
    if (!may_part(problem.rig->tools[own.tool])) return known_part(own.translation);
    for (const ToolPrint& print : tool_prints(model, problem, setting, forward, k))
        if (print.motion == motion) return print.stroke * print.contact.force.normalized();
    return Vec3::Zero();
}

/// The largest stroke and force of a tool over all actions, and where its columns stand.
struct Range {
    double stroke = 0;  // [mm]
    double force = 0;   // [N]
    int column = 0;     // of its play; that of the compliance follows
};

/// The strokes of each action's tools.
using Strokes = std::vector<std::vector<Vec3>>;

Strokes strokes_of(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                   const ForwardSolution& forward) {
    Strokes strokes(forward.actions.size());
    for (std::size_t k = 0; k < strokes.size(); ++k) {
        for (std::size_t i = 0; i < forward.actions[k].motions.size(); ++i)
            strokes[k].push_back(stroke_of(model, problem, setting, forward, static_cast<int>(k), i));
    }
    return strokes;
}

std::map<int, Range> ranges_of(const Problem& problem, const ForwardSolution& forward, const Strokes& strokes) {
    std::map<int, Range> ranges;
    for (std::size_t k = 0; k < forward.actions.size(); ++k) {
        for (std::size_t i = 0; i < strokes[k].size(); ++i) {
            const int tool = forward.actions[k].motions[i].tool;
            Range& range = ranges[tool];
            range.stroke = std::max(range.stroke, strokes[k][i].norm());
            range.force = std::max(range.force, force_on_body(problem, forward, k, tool).norm());
        }
    }
    return ranges;
}

/// How far a tool falls short of its motion (6 x 2): by its play, and by the compliance of what moves it.
Eigen::Matrix<double, 6, 2> shortfalls(const mesh::ToolMotion& motion, const Vec3& stroke, const Vec3& felt,
                                       const Range& range) {
    Eigen::Matrix<double, 6, 2> errors = Eigen::Matrix<double, 6, 2>::Zero();
    if (stroke.norm() > 0) errors.col(0).head<3>() = -range.stroke * stroke.normalized();
    if (range.force > 0) errors.col(1).head<3>() = -range.stroke / range.force * felt;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::isnan(motion.translation[axis])) errors.row(axis).setZero();  // it goes where no force acts
    }
    return errors;
}

/// What tools do that fall short of their motions in action k: columns of their play and of their compliance.
Signatures::InAction of_tools(const ReactionSlopes& slopes, const Problem& problem, const ForwardSolution& forward,
                              int k, const std::map<int, Range>& ranges, const std::vector<Vec3>& strokes) {
    Signatures::InAction own;
    const std::vector<mesh::ToolMotion>& motions = forward.actions[k].motions;
    const auto tools = std::ssize(motions);
    Eigen::MatrixXd poses = Eigen::MatrixXd::Zero(6 * tools, 2 * tools);
    for (Eigen::Index i = 0; i < tools; ++i) {
        const mesh::ToolMotion& motion = motions[static_cast<std::size_t>(i)];
        const Range& range = ranges.at(motion.tool);
        const Vec3 felt = force_on_body(problem, forward, static_cast<std::size_t>(k), motion.tool);
        poses.block<6, 2>(6 * i, 2 * i) = shortfalls(motion, strokes[static_cast<std::size_t>(i)], felt, range);
        own.columns.insert(own.columns.end(), {range.column, range.column + 1});
    }
    own.forces = -slopes.by_step.transpose() * poses;
    own.reactions = slopes.by_pose * poses;
    return own;
}

/// A cable is let out by some slack, and gives way, with its anchors, in proportion to its pull, which grows about with
/// what is drawn in. Elements add to that: an anchor at a point sinks in the more the finer they are.
/// Times as much as play, 5 % of what is drawn in: halved edges let the end of a tendon in a bar of 100 mm sink in
/// until its markers had moved by that share.
constexpr double of_give = 2.5;

/// The largest length that is drawn in of each cable [mm].
std::map<int, double> cables_of(const Problem& problem, const ForwardSolution& forward) {
    std::map<int, double> most;
    for (const Action& action : forward.actions) {
        for (const mesh::ActuatorSetting& setting : action.settings) {
            const auto* tendon = std::get_if<mesh::TendonActuator>(&problem.rig->actuators[setting.actuator].kind);
            if (tendon && tendon->by_length) most[setting.actuator] = std::max(most[setting.actuator], setting.value);
        }
    }
    std::erase_if(most, [](const auto& cable) { return !(cable.second > 0); });
    return most;
}

/// What cables do that are drawn in by less: columns of their slack and of their give.
void add_cables(const BodyModel& model, const ModelSetting& setting, const Action& action, const Eigen::VectorXd& q,
                const std::map<int, double>& most, int first, Signatures::InAction& own) {
    const bool any = std::ranges::any_of(action.settings, [&](const auto& one) { return most.contains(one.actuator); });
    if (!any) return;
    const Eigen::MatrixXd pull = model.actuation_force(q, setting, action);
    for (std::size_t a = 0; a < action.settings.size(); ++a) {
        const auto cable = most.find(action.settings[a].actuator);
        if (cable == most.end() || !(action.settings[a].value > 0)) continue;
        const int column = first + 2 * static_cast<int>(std::distance(most.begin(), cable));
        const Eigen::Index at = own.forces.cols();
        own.forces.conservativeResize(pull.rows(), at + 2);
        own.forces.col(at) = -cable->second * pull.col(static_cast<Eigen::Index>(a));
        own.forces.col(at + 1) = -of_give * action.settings[a].value * pull.col(static_cast<Eigen::Index>(a));
        own.columns.insert(own.columns.end(), {column, column + 1});
    }
    const Eigen::Index felt = own.reactions.cols(), tools = 6 * std::ssize(action.motions);
    own.reactions.conservativeResize(tools, own.forces.cols());
    own.reactions.rightCols(own.forces.cols() - felt).setZero();
}

}  // namespace

ToolNuisances tool_nuisances(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
                             const ForwardSolution& forward) {
    ToolNuisances result;
    const Strokes strokes = strokes_of(model, problem, setting, forward);
    std::map<int, Range> ranges = ranges_of(problem, forward, strokes);
    for (auto& [tool, range] : ranges) {
        range.column = static_cast<int>(result.names.size());
        result.names.push_back(fmt::format("play of the tool '{}'", problem.rig->tools[tool].name));
        result.names.push_back(fmt::format("compliance of what moves the tool '{}'", problem.rig->tools[tool].name));
    }
    const std::map<int, double> cables = cables_of(problem, forward);
    const auto first_cable = static_cast<int>(result.names.size());
    for (const auto& [cable, most] : cables) {
        result.names.push_back(fmt::format("slack of the tendon '{}'", problem.rig->actuators[cable].name));
        result.names.push_back(fmt::format("give of the tendon '{}'", problem.rig->actuators[cable].name));
    }
    result.signatures = {
        std::ssize(result.names), [&, setting, strokes, ranges, cables, first_cable](int k, const Eigen::VectorXd& q) {
            const Action& action = forward.actions[k];
            Signatures::InAction own;
            if (!action.motions.empty())
                own = of_tools(model.reaction_slopes(q, setting, action), problem, forward, k, ranges, strokes[k]);
            add_cables(model, setting, action, q, cables, first_cable, own);
            return own;
        }};
    return result;
}

}  // namespace palpate::identify
