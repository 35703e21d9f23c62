// What a page calls: a model under a hand, and its error on measurements. Built by emscripten alone; see build.sh.
//
// Functions that may fail give a negative number or null; play_message() then says why. Pointers to numbers hold until
// the next call.

#include <emscripten/emscripten.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/play/touch/running_comparison.h"
#include "pipeline/play/touch/set_text.h"
#include "pipeline/play/touch/touched_model.h"
#include "skeleton/model/io/model_io.h"

namespace {

using namespace palpate;
using pipeline::RunningComparison;
using pipeline::TouchedModel;

/// All that is alive in a page.
struct PageState {
    std::vector<skeleton::Model> models;
    std::vector<identify::MeasurementSet> sets;
    std::unique_ptr<TouchedModel> touched;
    std::unique_ptr<RunningComparison> comparison;
    int judged_set = -1;
    std::vector<skeleton::Attachment> markers;  // of one set, on the model that is played
    std::vector<double> numbers;                // what a call hands out
    std::string message, text;
};

PageState& played() {
    static PageState all;
    return all;
}

TouchedModel& touched() {
    if (!played().touched) throw std::logic_error("play_start comes first");
    return *played().touched;
}

/// Runs and catches: what went wrong is told by play_message.
template <class Result, class Run>
Result guarded(Result failed, const Run& run) {
    try {
        return run();
    } catch (const std::exception& error) {
        played().message = error.what();
        return failed;
    }
}

const double* handed_out(std::vector<double> numbers) {
    played().numbers = std::move(numbers);
    return played().numbers.data();
}
const double* rows_handed_out(const Points& rows) {
    return handed_out(std::vector<double>(rows.data(), rows.data() + rows.size()));
}

/// A model with those of its effects whose bit is set.
skeleton::Model with_effects(int model, unsigned effects) {
    skeleton::Model chosen = played().models.at(model);
    std::vector<skeleton::EffectRecord> kept;
    for (std::size_t e = 0; e < chosen.effects.size(); ++e) {
        if (effects >> e & 1U) kept.push_back(chosen.effects[e]);
    }
    chosen.effects = kept;
    return chosen;
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* play_message() { return played().message.c_str(); }

/// Reads the text of a model.json. The model's number.
EMSCRIPTEN_KEEPALIVE int play_read_model(const char* text) {
    return guarded(-1, [&] {
        const char* file = "model.json";
        std::ofstream(file) << text;
        played().models.push_back(skeleton::read_model(file));
        return static_cast<int>(played().models.size()) - 1;
    });
}

/// Reads a set as set_as_text writes it. The set's number.
EMSCRIPTEN_KEEPALIVE int play_read_set(const char* text) {
    return guarded(-1, [&] {
        played().sets.push_back(pipeline::set_from_text(nlohmann::json::parse(text)));
        return static_cast<int>(played().sets.size()) - 1;
    });
}

/// Takes a model up with those of its effects whose bits are set, under known gravity [mm/s^2] and pressure [MPa].
/// What was touched before stays so, and the body moves on from where it stood; `anew`: neither.
EMSCRIPTEN_KEEPALIVE int play_start(int model, unsigned effects, double gx, double gy, double gz, double pressure,
                                    int anew) {
    return guarded(-1, [&] {
        auto next = std::make_unique<TouchedModel>(with_effects(model, effects), Vec3(gx, gy, gz), pressure);
        if (played().touched && !anew) next->take_over(*played().touched);
        played().touched = std::move(next);
        played().markers.clear();
        return 0;
    });
}

/// What of the model is not played as it stands: sentences, a line each.
EMSCRIPTEN_KEEPALIVE const char* play_notices() {
    return guarded(static_cast<const char*>(nullptr), [] {
        played().text.clear();
        for (const std::string& notice : touched().body().notices()) played().text += notice + "\n";
        return played().text.c_str();
    });
}

EMSCRIPTEN_KEEPALIVE int play_vertices() { return touched().body().vertex_count(); }
EMSCRIPTEN_KEEPALIVE int play_triangles() { return static_cast<int>(touched().body().triangles().size()) / 3; }
EMSCRIPTEN_KEEPALIVE int play_spheres() { return touched().body().sphere_count(); }
/// (triangles x 3)
EMSCRIPTEN_KEEPALIVE const int* play_triangle_corners() { return touched().body().triangles().data(); }
/// (vertices x 3) [mm]
EMSCRIPTEN_KEEPALIVE const float* play_skin() { return touched().body().skin().data(); }
/// The same in double precision.
EMSCRIPTEN_KEEPALIVE const double* play_shape() {
    return guarded(static_cast<const double*>(nullptr),
                   [] { return rows_handed_out(touched().places(touched().model().skin)); });
}
/// (spheres x 3) [mm]
EMSCRIPTEN_KEEPALIVE const double* play_centres() { return rows_handed_out(touched().state().x); }

EMSCRIPTEN_KEEPALIVE int play_advance(double h) {
    return guarded(-1, [&] { return touched().advance(h), 0; });
}
/// Newton's steps that it took.
EMSCRIPTEN_KEEPALIVE int play_equilibrium() {
    return guarded(-1, [] { return touched().body().equilibrium().iterations; });
}
EMSCRIPTEN_KEEPALIVE void play_reset() { touched().reset(); }

/// Takes hold of the skin where it lies at (x, y, z) at rest. The touch's number.
EMSCRIPTEN_KEEPALIVE int play_touch(double x, double y, double z, double radius) {
    return guarded(-1, [&] { return touched().touch({x, y, z}, radius); });
}
EMSCRIPTEN_KEEPALIVE int play_release(int touch) {
    return guarded(-1, [&] { return touched().release(touch), 0; });
}
EMSCRIPTEN_KEEPALIVE int play_push(int touch, double x, double y, double z) {
    return guarded(-1, [&] { return touched().push(touch, {x, y, z}), 0; });
}
/// A force that has crept already.
EMSCRIPTEN_KEEPALIVE int play_bear(int touch, double x, double y, double z) {
    return guarded(-1, [&] { return touched().push_without_creep(touch, {x, y, z}), 0; });
}
EMSCRIPTEN_KEEPALIVE int play_drag(int touch, double x, double y, double z, double stiffness) {
    return guarded(-1, [&] { return touched().drag(touch, {x, y, z}, stiffness), 0; });
}
/// Force on the body [N], place, place at rest [mm], radius [mm], what the body bears [N]: 13 numbers.
EMSCRIPTEN_KEEPALIVE const double* play_at(int touch) {
    return guarded(static_cast<const double*>(nullptr), [&] {
        const Vec3 f = touched().force(touch), x = touched().place(touch), b = touched().effective_force(touch);
        const TouchedModel::Touch& own = touched().touches()[touch];
        return handed_out(
            {f[0], f[1], f[2], x[0], x[1], x[2], own.rest[0], own.rest[1], own.rest[2], own.radius, b[0], b[1], b[2]});
    });
}
/// d place / d force at a touch (3 x 3) [mm/N]; null where the body is not stable as it stands.
EMSCRIPTEN_KEEPALIVE const double* play_compliance(int touch) {
    return guarded(static_cast<const double*>(nullptr), [&]() -> const double* {
        const std::optional<Mat3> C = touched().compliance(touch);
        if (!C) return nullptr;
        return handed_out(std::vector<double>(C->data(), C->data() + 9));
    });
}

/// Brings a rigid ball to a place, which presses on the skin there.
EMSCRIPTEN_KEEPALIVE int play_place_ball(double radius, double x, double y, double z) {
    return guarded(-1, [&] { return touched().place_ball(radius, {x, y, z}), 0; });
}
EMSCRIPTEN_KEEPALIVE void play_lift_ball() { touched().lift_ball(); }
/// Force of the ball on the body [N]: 3 numbers.
EMSCRIPTEN_KEEPALIVE const double* play_ball_force() {
    return guarded(static_cast<const double*>(nullptr), [] {
        const Vec3 f = touched().ball_force();
        return handed_out({f[0], f[1], f[2]});
    });
}

/// Adds an actuator as actuator_as_text writes it, at 0. Its number.
EMSCRIPTEN_KEEPALIVE int play_add_actuator(const char* text) {
    return guarded(-1,
                   [&] { return touched().add_actuator(pipeline::actuator_from_text(nlohmann::json::parse(text))); });
}
/// Pressure [MPa], tension [N] or length drawn in [mm].
EMSCRIPTEN_KEEPALIVE int play_drive(int actuator, double value) {
    return guarded(-1, [&] { return touched().drive(actuator, value), 0; });
}
/// Of a tendon [N]: one number.
EMSCRIPTEN_KEEPALIVE const double* play_tension(int actuator) {
    return guarded(static_cast<const double*>(nullptr), [&] { return handed_out({touched().tension(actuator)}); });
}

/// Begins to judge a model with those of its effects on a set. How many states there are to judge.
EMSCRIPTEN_KEEPALIVE int play_judge(int model, unsigned effects, int set) {
    return guarded(-1, [&] {
        played().comparison = std::make_unique<RunningComparison>(with_effects(model, effects), played().sets.at(set));
        played().judged_set = set;
        return played().comparison->count();
    });
}
/// Judges the next: sum of squares [mm^2], coordinates, 1 where the whole load is borne, the state in the set.
EMSCRIPTEN_KEEPALIVE const double* play_judge_state(int r) {
    return guarded(static_cast<const double*>(nullptr), [&] {
        const RunningComparison::Error error = played().comparison->evaluate(r);
        return handed_out({error.squares, static_cast<double>(error.coordinates), error.is_full_load ? 1.0 : 0.0,
                           static_cast<double>(played().comparison->readings(r).state)});
    });
}

/// A set's markers as the body stands (markers x 3) [mm].
EMSCRIPTEN_KEEPALIVE const double* play_markers(int set) {
    return guarded(static_cast<const double*>(nullptr), [&] {
        if (played().markers.empty()) {
            const skeleton::Attacher attach(touched().model());
            for (const identify::Marker& marker : played().sets.at(set).markers) {
                played().markers.push_back(attach(marker.anchor.value_or(marker.rest), marker.rest));
            }
        }
        return rows_handed_out(touched().places(played().markers));
    });
}

}  // extern "C"
