#include "identify/diagnosis/locate/sources/source_laws.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace palpate::identify {
namespace {

Eigen::VectorXd over_largest(Eigen::VectorXd values) {
    const double most = values.cwiseAbs().maxCoeff();
    if (most > 0) values /= most;
    return values;
}

/// Do two laws differ in some state by more than rounding of tables does?
bool differ(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    constexpr double rounding = 0.01;
    return (a - b).cwiseAbs().maxCoeff() > rounding;
}

}  // namespace

Eigen::VectorXd relative_loads(const Problem& problem) {
    const auto count = std::ssize(problem.stages);
    Eigen::MatrixXd kinds(count, 3);
    for (Eigen::Index s = 0; s < count; ++s) {
        const LoadSizes sizes = sizes_of(problem.stages[s].action);
        kinds.row(s) << sizes.force, sizes.way, sizes.setting;
    }
    // Newtons and millimetres do not add up: each kind counts by its own largest.
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(count);
    for (int c = 0; c < 3; ++c) sum += over_largest(kinds.col(c));
    return over_largest(sum);
}

int read_states(const Problem& problem) {
    const std::set<int> states(problem.state.begin(), problem.state.end());
    return static_cast<int>(states.size());
}

std::vector<int> states_shown(const Problem& problem, const Eigen::VectorXd& altered) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(std::ssize(problem.stages)), count = squares;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        squares[problem.state[n]] += altered[n] * altered[n];
        count[problem.state[n]] += 1;
    }
    const Eigen::VectorXd shown = squares.cwiseQuotient(count.cwiseMax(1)).cwiseSqrt();
    constexpr double notable = 0.2;  // of the most: less is within what a first-order model errs by
    std::vector<int> states;
    for (Eigen::Index s = 0; s < shown.size(); ++s)
        if (shown[s] > 0 && shown[s] >= notable * shown.maxCoeff()) states.push_back(static_cast<int>(s));
    return states;
}

std::vector<std::pair<SourceLaw, Eigen::VectorXd>> common_laws(const Problem& problem) {
    const auto count = std::ssize(problem.stages);
    const Eigen::VectorXd load = relative_loads(problem);
    Eigen::VectorXd time(count), before(count);
    std::map<int, double> begun, largest;
    for (Eigen::Index s = 0; s < count; ++s) {
        const Stage& stage = problem.stages[s];
        const int life = problem.continuous ? 0 : stage.probe;  // of one body
        time[s] = stage.time - begun.try_emplace(stage.probe, stage.time).first->second;
        double& most = largest.try_emplace(life, 0).first->second;
        most = std::max(most, load[s]);
        before[s] = most;
    }
    // As creep goes: fast at first, in decades of the time.
    const double end = time.maxCoeff();
    constexpr double first = 0.05;  // of the longest time: where it has begun to count; design choice
    if (end > 0) time = (1 + time.array() / (first * end)).log();

    std::vector<std::pair<SourceLaw, Eigen::VectorXd>> laws{{SourceLaw::constant, Eigen::VectorXd::Ones(count)}};
    const auto add = [&](SourceLaw law, Eigen::VectorXd strength) {
        strength = over_largest(std::move(strength));
        if (strength.isZero(0)) return;
        if (std::ranges::all_of(laws, [&](const auto& one) { return differ(one.second, strength); }))
            laws.emplace_back(law, std::move(strength));
    };
    add(SourceLaw::proportional, load);
    add(SourceLaw::quadratic, load.cwiseAbs2());
    add(SourceLaw::with_time, time);
    add(SourceLaw::with_history, before);
    return laws;
}

std::vector<std::pair<int, Eigen::VectorXd>> probes_alone(const Problem& problem) {
    std::vector<std::pair<int, Eigen::VectorXd>> probes;
    for (std::size_t s = 0; s < problem.stages.size(); ++s) {
        const Stage& stage = problem.stages[s];
        if (!is_loaded(stage.action)) continue;
        auto own = std::ranges::find(probes, stage.probe, &std::pair<int, Eigen::VectorXd>::first);
        if (own == probes.end()) {
            probes.emplace_back(stage.probe, Eigen::VectorXd::Zero(std::ssize(problem.stages)));
            own = probes.end() - 1;
        }
        own->second[static_cast<Eigen::Index>(s)] = 1;
    }
    return probes;
}

}  // namespace palpate::identify
