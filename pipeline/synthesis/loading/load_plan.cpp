#include "pipeline/synthesis/loading/load_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"

namespace palpate::pipeline {
namespace {

constexpr double less = 0.7;  // of its force, for a probe without equilibrium

struct Pressed {
    double force = 0;   // [N]
    Eigen::VectorXd q;  // empty: no equilibrium at any force
};

/// Scales loads on a specimen with nothing hidden in force.
class Scaling {
public:
    Scaling(const Specimen& specimen, Eigen::VectorXd unloaded)
        : specimen_(specimen), unloaded_(std::move(unloaded)), conditions_{.setting = specimen.setting} {}

    const Eigen::VectorXd& unloaded() const { return unloaded_; }
    double distance(const Eigen::VectorXd& q) const { return largest_distance(specimen_, unloaded_, q); }

    /// Steps from the unloaded configuration that 1 N on each contact would make by its tangent.
    std::vector<Eigen::VectorXd> unit_steps() const {
        const identify::BodyModel& model = *specimen_.model;
        const auto tangent = model.tangent(unloaded_, specimen_.setting, {});
        std::vector<Eigen::VectorXd> steps;
        steps.reserve(specimen_.contacts.size());
        for (const mesh::Contact& contact : specimen_.contacts) {
            steps.emplace_back(tangent->solve(model.contact_force(unloaded_, specimen_.setting, contact)));
        }
        return steps;
    }

    /// The force that moves the body by `wanted` [mm], sought from where `before` left it.
    Pressed press(const mesh::Contact& contact, const Eigen::VectorXd& unit_step, double wanted,
                  const Pressed& before) const {
        if (specimen_.in_small_strain()) return press_linearly(unit_step, wanted);
        const double slope = compliance(unit_step);
        const double guess = before.force > 0 ? before.force * wanted / distance(before.q) : wanted / slope;
        return press_by_secants(contact, wanted, {std::min(guess, specimen_.most_force), before.q});
    }

    /// Empty: there is none.
    Eigen::VectorXd equilibrium(const mesh::Contact& contact, double force, const Eigen::VectorXd& near) const {
        const std::vector<EquilibriumPath> start{{near}};
        EquilibriumPath path =
            simulate(specimen_, conditions_, {{.probe = 1, .contact = contact, .rows = {{1, force}}}}, {}, &start)
                .front();
        return path.empty() ? Eigen::VectorXd() : path.front();
    }

private:
    /// Largest displacement per newton, for little of it: so that nothing turns far [mm/N].
    double compliance(const Eigen::VectorXd& unit_step) const {
        const double small = 1e-4 * specimen_.model->size() / unit_step.cwiseAbs().maxCoeff();
        return distance(specimen_.model->advance(unloaded_, small * unit_step, specimen_.setting)) / small;
    }

    Pressed press_linearly(const Eigen::VectorXd& unit_step, double wanted) const {
        const double force = std::min(wanted / compliance(unit_step), specimen_.most_force);
        return {force, specimen_.model->advance(unloaded_, force * unit_step, specimen_.setting)};
    }

    Pressed press_by_secants(const mesh::Contact& contact, double wanted, Pressed trial) const {
        constexpr double close = 0.02;
        constexpr int plays = 6;
        Pressed last;
        double last_moved = 0;
        for (int i = 0; i < plays; ++i) {
            const Eigen::VectorXd q = equilibrium(contact, trial.force, trial.q);
            if (q.size() == 0) {
                trial.force *= less;
                continue;
            }
            const double moved = distance(q);
            // d ln displacement / d ln force by the last two plays, 1 at first
            double slope = 1;
            if (last_moved > 0 && std::abs(trial.force / last.force - 1) > 1e-3) {
                slope = std::clamp(std::log(moved / last_moved) / std::log(trial.force / last.force), 0.3, 3.0);
            }
            last = {trial.force, q};
            last_moved = moved;
            const bool at_most = trial.force == specimen_.most_force && moved < wanted;
            if (at_most || std::abs(moved / wanted - 1) < close) break;
            const double factor = std::clamp(std::pow(wanted / moved, 1 / slope), 0.3, 3.0);
            trial = {std::min(trial.force * factor, specimen_.most_force), q};
        }
        return last;
    }

    const Specimen& specimen_;
    const Eigen::VectorXd unloaded_;
    const TrueConditions conditions_;
};

/// The configurations of the rows of a history, out of those at its forces and the unloaded one.
EquilibriumPath path_of(const ProbeLoadHistory& history, const std::vector<Pressed>& pressed,
                        const Eigen::VectorXd& unloaded) {
    EquilibriumPath path;
    for (const Row& row : history.rows) {
        const auto found = std::ranges::find(pressed, row.force, &Pressed::force);
        path.push_back(row.force == 0 ? unloaded : found->q);
    }
    return path;
}

void leave_out_failed(Plan& plan) {
    std::vector<char> without;
    without.reserve(plan.baseline.size());
    for (const EquilibriumPath& path : plan.baseline) without.push_back(path.empty());
    leave_out(plan, without);
}

}  // namespace

Plan make_plan(const Specimen& specimen, const Sequence& sequence, double largest, int threads,
               const Progress& progress) {
    report(progress, "finding the loads", 0.0);
    Plan plan{{unloaded_history()}, {}, {}};
    plan.baseline = simulate(specimen, {.setting = specimen.setting}, plan.histories, {});
    if (plan.baseline.front().empty()) {
        throw SolverFailure(
            "the body finds no equilibrium though nothing touches it; is it held, and stiff enough "
            "for its own effects?");
    }
    if (!specimen.driven.empty()) {
        for (ProbeLoadHistory history : specimen.driven) {
            std::vector<double> amounts;
            amounts.reserve(history.rows.size());
            for (const Row& row : history.rows) amounts.push_back(row.force);
            history.rows = rows_of(amounts, sequence.timing);
            plan.histories.push_back(std::move(history));
        }
        plan.baseline = simulate(specimen, {.setting = specimen.setting}, plan.histories, {.threads = threads});
        leave_out_failed(plan);
        report(progress, "finding the loads", 1.0);
        return plan;
    }
    const Scaling scaling(specimen, plan.baseline.front().front());
    const std::vector<Eigen::VectorXd> unit_steps = scaling.unit_steps();

    const std::size_t count = specimen.contacts.size();
    plan.histories.resize(count + 1);
    plan.baseline.resize(count + 1);
    identify::for_each_in_parallel(static_cast<int>(count), threads, [&](int p) {
        const mesh::Contact& contact = specimen.contacts[p];
        std::vector<Pressed> pressed;
        std::vector<double> forces;
        for (const double level : levels_of(p, sequence.levels)) {
            const Pressed before = pressed.empty() ? Pressed{0, scaling.unloaded()} : pressed.back();
            pressed.push_back(scaling.press(contact, unit_steps[p], level * largest, before));
            forces.push_back(pressed.back().force);
            if (pressed.back().q.size() == 0) break;
        }
        plan.histories[p + 1] = {.probe = p + 1, .contact = contact, .rows = rows_of(forces, sequence.timing)};
        if (pressed.back().q.size() > 0) {
            plan.baseline[p + 1] = path_of(plan.histories[p + 1], pressed, scaling.unloaded());
        }
    });
    leave_out_failed(plan);
    report(progress, "finding the loads", 1.0);
    return plan;
}

void reduce_forces(const Specimen& specimen, Plan& plan, const std::vector<char>& which, int threads) {
    std::vector<char> without(plan.histories.size(), 0);
    const Scaling scaling(specimen, plan.baseline.front().front());
    identify::for_each_in_parallel(static_cast<int>(plan.histories.size()), threads, [&](int c) {
        if (!which[c]) return;
        for (std::size_t row = 0; row < plan.histories[c].rows.size(); ++row) {
            double& force = plan.histories[c].rows[row].force;
            if (force == 0) continue;
            force *= less;
            Eigen::VectorXd& q = plan.baseline[c][row];
            q = scaling.equilibrium(plan.histories[c].contact, force, q);
            if (q.size() == 0) without[c] = 1;
        }
    });
    leave_out(plan, without);
}

void leave_out(Plan& plan, const std::vector<char>& which) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < plan.histories.size(); ++c) {
        if (which[c]) {
            plan.notes.push_back(fmt::format("Probe {} finds no equilibrium, though it presses less: it is left out.",
                                             plan.histories[c].probe));
            continue;
        }
        if (kept != c) {
            plan.histories[kept] = std::move(plan.histories[c]);
            plan.baseline[kept] = std::move(plan.baseline[c]);
        }
        ++kept;
    }
    plan.histories.resize(kept);
    plan.baseline.resize(kept);
    if (kept < 2) throw SolverFailure("no probe finds an equilibrium; ask for a smaller displacement");
}

}  // namespace palpate::pipeline
