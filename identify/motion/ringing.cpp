#include "identify/motion/ringing.h"

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"
#include "identify/loading/readings.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

using skeleton::Equilibrium;
using skeleton::Model;
using skeleton::State;

/// The step that leads from one equilibrium to another, by the model's law (6N).
Eigen::VectorXd step_between(const Model& model, const Equilibrium& from, const Equilibrium& to) {
    if (model.law == skeleton::EquilibriumLaw::linear) return to.step - from.step;
    Eigen::VectorXd step(model.dofs());
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        step.segment<3>(6 * row) = (to.state.x.row(row) - from.state.x.row(row)).transpose();
        step.segment<3>(6 * row + 3) = skeleton::rotation_vector(to.state.R[i] * from.state.R[i].transpose());
    }
    return step;
}

/// Rows of a recording's readings: x, y, z of each marker, a column an instant.
void fill_readings(const MotionRecording& recording, const MeasurementSet& set, Ringdown& ringdown) {
    const auto rows = 3 * static_cast<Eigen::Index>(set.markers.size());
    const auto instants = static_cast<Eigen::Index>(recording.instants.size());
    ringdown.times.resize(instants);
    ringdown.measured = Eigen::MatrixXd::Constant(rows, instants, missing);
    ringdown.weights = Eigen::MatrixXd::Zero(rows, instants);
    for (Eigen::Index t = 0; t < instants; ++t) {
        const MotionRecording::Instant& instant = recording.instants[t];
        ringdown.times[t] = instant.time;
        for (const Reading& reading : instant.readings) {
            const double sigma = std::isnan(reading.sigma) ? set.position_noise.value_or(1) : reading.sigma;
            for (int axis = 0; axis < 3; ++axis) {
                if (std::isnan(reading.position[axis])) continue;
                ringdown.measured(3 * reading.marker + axis, t) = reading.position[axis];
                ringdown.weights(3 * reading.marker + axis, t) = 1 / sigma;
            }
        }
    }
}

/// Equilibria of a model under what a set's recordings tell.
class Equilibria {
public:
    Equilibria(const Model& model, const MeasurementSet& set)
        : model_(model),
          set_(set),
          k_(skeleton::stiffness_vector(model)),
          loads_(model),
          markers_(marker_attachments(model, set.markers)),
          solver_(model) {}

    Equilibrium of(const LoadState& load, const Equilibrium* near) {
        return solver_.solve(k_, loads_(set_, load), {}, near);
    }
    /// Coordinates of the markers (3m).
    Eigen::VectorXd seen(const LoadState& load, const Equilibrium& at) const {
        return skeleton::observed(model_, at, loads_(set_, load), markers_).reshaped<Eigen::RowMajor>();
    }
    /// d seen / d step (3m x 6N).
    Eigen::SparseMatrix<double> jacobian(const Equilibrium& at) const {
        return skeleton::observation_jacobian(model_, at, markers_);
    }
    const skeleton::StaticsSolver& factored(const LoadState& load, const Equilibrium& at) {
        solver_.factor_tangent(k_, loads_(set_, load), at);
        return solver_;
    }

private:
    const Model& model_;
    const MeasurementSet& set_;
    Eigen::VectorXd k_;
    ContactLoads loads_;
    std::vector<skeleton::Attachment> markers_;
    skeleton::StaticsSolver solver_;
};

/// What acts on each stretch of a recording; the first is what it begins with.
struct Acting {
    double begins;
    const LoadState* load;
};
std::vector<Acting> acting_on(const MotionRecording& recording, const LoadState& nothing) {
    std::vector<const LoadState*> loads;
    loads.reserve(recording.loads.size());
    for (const LoadState& load : recording.loads) loads.push_back(&load);
    const LoadState* before = acting_before(loads);
    std::vector<Acting> acting{{.begins = -INFINITY, .load = before ? before : &nothing}};
    double time = 0;
    for (const LoadState* load : loads) {
        if (load == before) continue;
        acting.push_back({time, load});
        time = load->time;
    }
    return acting;
}

}  // namespace

Eigen::Vector2d Oscillator::after(double time, const Eigen::Vector2d& start) const {
    const double dies = ratio * frequency, root = frequency * std::sqrt(std::abs(1 - ratio * ratio));
    double c = 0, s = 0;  // exp(-dies t) times cos or cosh, and times sin or sinh over the root
    if (root * time < 1e-6) {
        c = std::exp(-dies * time);
        s = c * time;
    } else if (ratio < 1) {
        c = std::exp(-dies * time) * std::cos(root * time);
        s = std::exp(-dies * time) * std::sin(root * time) / root;
    } else {
        const double slow = std::exp((root - dies) * time), fast = std::exp(-(root + dies) * time);
        c = (slow + fast) / 2;
        s = (slow - fast) / (2 * root);
    }
    return {(c + dies * s) * start[0] + s * start[1],
            -frequency * frequency * s * start[0] + (c - dies * s) * start[1]};
}

Eigen::MatrixXd Ringdown::played(const Eigen::MatrixXd& shapes, const std::vector<Oscillator>& modes,
                                 const Eigen::VectorXd& gain, double delay) const {
    Eigen::MatrixXd rests(shapes.rows(), times.size()), deviation(shapes.cols(), times.size());
    std::vector<Eigen::Vector2d> start(modes.size(), Eigen::Vector2d::Zero());
    std::size_t current = 0;
    const auto moves_in = [](const Stretch& stretch) { return std::isfinite(stretch.begins); };
    for (Eigen::Index t = 0; t < times.size(); ++t) {
        const double now = times[t] - delay;
        while (current + 1 < stretches.size() && now >= stretches[current + 1].begins) {
            const Stretch &ended = stretches[current], &next = stretches[++current];
            for (std::size_t i = 0; i < modes.size(); ++i) {
                if (moves_in(ended)) start[i] = modes[i].after(next.begins - ended.begins, start[i]);
                start[i][0] += gain[static_cast<Eigen::Index>(i)] * next.jump[static_cast<Eigen::Index>(i)];
            }
        }
        rests.col(t) = stretches[current].rests;
        for (std::size_t i = 0; i < modes.size(); ++i) {
            deviation(static_cast<Eigen::Index>(i), t) =
                moves_in(stretches[current]) ? modes[i].after(now - stretches[current].begins, start[i])[0] : 0;
        }
    }
    return rests + shapes * deviation;
}

Ringdowns ringdowns(const Model& model, const MeasurementSet& set, int modes) {
    Ringdowns all;
    Equilibria equilibria(model, set);
    const LoadState nothing;
    std::vector<std::vector<Equilibrium>> found;  // of each stretch of each recording
    for (const MotionRecording& recording : set.recordings) {
        Ringdown& ringdown = all.recordings.emplace_back();
        fill_readings(recording, set, ringdown);
        std::vector<Equilibrium>& stations = found.emplace_back();
        for (const Acting& acting : acting_on(recording, nothing)) {
            stations.push_back(equilibria.of(*acting.load, stations.empty() ? nullptr : &stations.back()));
            ringdown.stretches.push_back(
                {.begins = acting.begins, .jump = {}, .rests = equilibria.seen(*acting.load, stations.back())});
        }
    }
    // vibrations about what all is over in, of the first recording: others are near
    const Equilibrium& last = found.front().back();
    State state = model.law == skeleton::EquilibriumLaw::linear ? skeleton::rest_state(model) : last.state;
    all.vibration = vibration(model, equilibria.factored(set.recordings.front().loads.back(), last), state, modes);
    all.shapes = equilibria.jacobian(last) * all.vibration.shapes;
    const Eigen::MatrixXd momenta = times_mass(model, state, all.vibration.shapes);
    for (std::size_t r = 0; r < found.size(); ++r) {
        for (std::size_t s = 1; s < found[r].size(); ++s)
            all.recordings[r].stretches[s].jump =
                momenta.transpose() * step_between(model, found[r][s], found[r][s - 1]);
    }
    return all;
}

Ringdowns of_modes(const Ringdowns& all, const std::vector<int>& which) {
    Ringdowns some = all;
    some.vibration = {.frequencies = all.vibration.frequencies(which),
                      .shapes = all.vibration.shapes(Eigen::all, which)};
    some.shapes = all.shapes(Eigen::all, which);
    for (Ringdown& recording : some.recordings) {
        for (std::size_t s = 1; s < recording.stretches.size(); ++s) {
            recording.stretches[s].jump = Eigen::VectorXd(recording.stretches[s].jump(which));
        }
    }
    return some;
}

}  // namespace palpate::identify
