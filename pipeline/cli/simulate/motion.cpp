#include "pipeline/cli/simulate/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/loading/loads.h"
#include "identify/measurements/files/read_markers.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "pipeline/command_line/terminal/console.h"
#include "skeleton/runtime/body.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// A probe's states in their order.
using Probe = std::vector<const identify::LoadState*>;

std::vector<Probe> by_probe(const std::vector<identify::LoadState>& states) {
    std::vector<Probe> probes;
    for (const identify::LoadState& state : states) {
        if (probes.empty() || probes.back().front()->probe != state.probe) probes.emplace_back();
        probes.back().push_back(&state);
    }
    return probes;
}

/// Plays a body through probes and writes its skin, frame by frame.
class Motion {
public:
    Motion(const SimulateOptions& options, const fs::path& output, const skeleton::Model& model, int contacts)
        : dt_(*options.dt),
          frames_(std::max(1, static_cast<int>(std::lround(*options.duration / dt_)))),
          implicit_(options.implicit),
          output_(output),
          model_(model),
          body_(model, {.damping_ratio = options.damping, .contacts = contacts}) {
        Console::notices(body_.notices());
        if (!implicit_) steps_ = std::max(1, static_cast<int>(std::ceil(dt_ / (0.5 * body_.stable_step()))));
    }

    /// Explicit steps a frame; one where they are implicit.
    int steps() const { return steps_; }
    const runtime::RayleighDamping& damping() const { return body_.damping(); }

    nlohmann::json play(const Probe& probe) {
        body_.reset();
        pressed_.clear();
        const identify::LoadState* acting = identify::acting_before(probe);
        if (acting) press(*acting);
        if (std::ranges::any_of(model_.spheres, &skeleton::Sphere::held)) body_.equilibrium();
        double furthest = write_frame();
        for (int frame = 0; frame < frames_; ++frame) {
            const identify::LoadState* now = identify::acting_at(probe, (frame + 0.5) * dt_);
            if (now != acting) press(*now);
            acting = now;
            if (implicit_) {
                body_.step_implicit(dt_);
            } else {
                body_.step_explicit(dt_ / steps_, steps_);
            }
            furthest = std::max(furthest, write_frame());
        }
        return {{"probe", probe.front()->probe}, {"frames", frames_ + 1}, {"max_displacement_mm", furthest}};
    }

    void write_series() const { mesh::write_pvd(output_ / "simulation.pvd", series_); }

private:
    // A contact that goes on is held, as what it does creeps; one that does not fades.
    void press(const identify::LoadState& state) {
        std::vector<Pressed> before;
        before.swap(pressed_);
        for (const mesh::Contact& contact : state.contacts) {
            if (contact.force.isZero(0)) continue;
            const auto goes_on = std::ranges::find_if(before, [&](const Pressed& was) {
                return was.at.point == contact.point && was.at.radius == contact.radius;
            });
            if (goes_on != before.end()) {
                pressed_.push_back(*goes_on);
                before.erase(goes_on);
            } else {
                pressed_.push_back({contact, body_.touch(contact.point, contact.radius)});
            }
            body_.push(pressed_.back().contact, contact.force);
        }
        for (const Pressed& was : before) body_.release(was.contact);
    }

    /// The largest displacement [mm].
    double write_frame() {
        using SkinRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
        const std::vector<float>& skin = body_.skin();
        const Points u =
            Eigen::Map<const SkinRows>(skin.data(), body_.vertex_count(), 3).cast<double>() - model_.surface.vertices;
        const auto frame = series_.size();
        const fs::path file = output_ / fmt::format("simulation_{:05}.vtp", frame);
        mesh::write_vtp(file, model_.surface, {.points = {{"displacement [mm]", u}}});
        series_.push_back({static_cast<double>(frame) * dt_, file});
        return u.rows() > 0 ? u.rowwise().norm().maxCoeff() : 0;
    }

    double dt_;
    int frames_;
    bool implicit_;
    int steps_ = 1;
    fs::path output_;
    const skeleton::Model& model_;
    runtime::Body body_;
    struct Pressed {
        mesh::Contact at;
        int contact = 0;  // of the body
    };
    std::vector<Pressed> pressed_;
    std::vector<mesh::SeriesStep> series_;
};

}  // namespace

Outcome simulate_motion(const SimulateOptions& options, const skeleton::Model& model, const fs::path& output) {
    if (model.skin.empty())
        throw InvalidInput(options.model.string() + ": has no skin that could be pressed; give the model one");
    const std::vector<identify::LoadState> states = identify::read_probes(options.probes);
    std::size_t contacts = 1;
    for (const identify::LoadState& state : states) contacts = std::max(contacts, state.contacts.size());
    constexpr std::size_t most = 64;  // of a runtime body (runtime::BodyOptions)
    Motion motion(options, output, model, static_cast<int>(std::min(most, 2 * contacts + 2)));  // some of them fading
    Console::notice(fmt::format("Motion by {}; damping {}: {:.3g} 1/s times mass and {:.3g} s times stiffness.",
                                options.implicit ? fmt::format("implicit steps of {:g} s", *options.dt)
                                                 : fmt::format("{} explicit steps a frame", motion.steps()),
                                model.damping && !options.damping
                                    ? "as identified"
                                    : fmt::format("ratio {:g} of the softest mode", options.damping.value_or(0.1)),
                                motion.damping().alpha, motion.damping().beta));
    Outcome outcome;
    nlohmann::json probes = nlohmann::json::array();
    for (const Probe& probe : by_probe(states)) probes.push_back(motion.play(probe));
    motion.write_series();
    outcome.text = fmt::format("{0}: {1} probes in motion.\nNext: paraview {0}\n", (output / "simulation.pvd").string(),
                               probes.size());
    outcome.json = {{"file", (output / "simulation.pvd").string()},
                    {"dt_s", *options.dt},
                    {"steps_per_frame", motion.steps()},
                    {"damping", {{"mass", motion.damping().alpha}, {"stiffness", motion.damping().beta}}},
                    {"probes", probes}};
    return outcome;
}

}  // namespace palpate::pipeline::commands
