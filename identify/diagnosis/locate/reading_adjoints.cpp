#include "identify/diagnosis/locate/reading_adjoints.h"

#include <algorithm>
#include <array>
#include <map>

#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

/// d channels / d step, as they are read: rows of some channels' coordinates (r x dofs).
class ChannelRows {
public:
    ChannelRows(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                const ForwardSolution& forward, int k)
        : problem_(problem), action_(forward.actions[k]) {
        const ModelSetting setting = explanation.setting();
        positions_ = model.observation(forward.q[k], setting);
        if (!action_.motions.empty()) reactions_ = model.reaction_slopes(forward.q[k], setting, action_).by_step;
        if (explanation.effects.empty()) return;
        // Faults of the measurement that are known: an affine map of each marker.
        const Points base = explanation.read(problem, forward.channels[k]);
        for (int axis = 0; axis < 3; ++axis) {
            Points moved = forward.channels[k];
            moved.col(axis).array() += 1;
            seen_[axis] = explanation.read(problem, moved) - base;
        }
    }

    Eigen::VectorXd row(int coordinate) const {
        const int channel = coordinate / 3, axis = coordinate % 3;
        if (channel >= problem_.markers) return reaction_row(channel - problem_.markers, axis);
        if (seen_[0].size() == 0) return positions_.row(coordinate).transpose();
        Eigen::VectorXd result = Eigen::VectorXd::Zero(positions_.cols());
        for (int from = 0; from < 3; ++from)
            result += seen_[from](channel, axis) * Eigen::VectorXd(positions_.row(3 * channel + from).transpose());
        return result;
    }

private:
    Eigen::VectorXd reaction_row(int channel, int axis) const {
        const int tool = channel / 2, part = channel % 2;  // force, moment
        for (std::size_t i = 0; i < action_.motions.size(); ++i) {
            if (action_.motions[i].tool == tool)
                return reactions_.row(6 * static_cast<Eigen::Index>(i) + 3 * part + axis).transpose();
        }
        return Eigen::VectorXd::Zero(positions_.cols());
    }

    const Problem& problem_;
    const Action& action_;
    Eigen::SparseMatrix<double, Eigen::RowMajor> positions_;
    Eigen::MatrixXd reactions_;
    std::array<Points, 3> seen_;
};

}  // namespace

std::vector<ReadingEntry> reading_entries(const Problem& problem) {
    std::vector<ReadingEntry> entries;
    entries.reserve(static_cast<std::size_t>(problem.rows()));
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        entries.push_back({n, problem.action[n], problem.state[n], 1});
        if (problem.is_difference(n)) entries.push_back({n, problem.since[n], problem.since_state[n], -1});
    }
    std::ranges::stable_sort(entries, {}, &ReadingEntry::action);
    return entries;
}

void for_each_adjoint(const BodyModel& model, const Problem& problem, const Explanation& explanation,
                      const ForwardSolution& forward, const std::vector<ReadingEntry>& entries, int threads,
                      const std::function<void(const ActionAdjoint&)>& visit) {
    const ModelSetting setting = explanation.setting();
    std::shared_ptr<const Tangent> linear;
    if (!model.is_nonlinear(setting)) linear = model.tangent(model.rest(setting), setting, {});
    for_each_in_parallel(static_cast<int>(problem.actions.size()), threads, [&](int k) {
        const auto begin = std::ranges::lower_bound(entries, k, {}, &ReadingEntry::action);
        const auto end = std::ranges::upper_bound(entries, k, {}, &ReadingEntry::action);
        if (begin == end) return;
        ActionAdjoint adjoint{.action = k, .first = begin - entries.begin()};
        adjoint.scale.resize(end - begin);
        std::vector<int> coordinates;
        std::map<int, Eigen::Index> column_of;
        for (auto entry = begin; entry != end; ++entry) {
            const int coordinate = problem.coordinate[entry->row];
            const auto [at, is_new] = column_of.try_emplace(coordinate, std::ssize(coordinates));
            if (is_new) coordinates.push_back(coordinate);
            adjoint.scale[entry - begin] = 1 / problem.sigma[entry->row];
            adjoint.columns.push_back(at->second);
        }
        const ChannelRows rows(model, problem, explanation, forward, k);
        adjoint.by_step.resize(model.dofs(), std::ssize(coordinates));
        for (std::size_t c = 0; c < coordinates.size(); ++c)
            adjoint.by_step.col(static_cast<Eigen::Index>(c)) = rows.row(coordinates[c]);
        const auto make = [&] { return model.tangent(forward.q[k], setting, forward.actions[k]); };
        const auto tangent = linear ? linear : forward.tangents ? forward.tangents->get(k, make) : make();
        adjoint.by_force = tangent->solve(adjoint.by_step);
        visit(adjoint);
    });
}

}  // namespace palpate::identify
