#include "pipeline/live/follow.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "identify/inference/methods/methods.h"
#include "identify/measurements/field.h"
#include "identify/measurements/labels/label_readings.h"
#include "identify/measurements/measurement_places.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/live/cloud_file.h"
#include "pipeline/live/json_lines.h"
#include "pipeline/live/set_tail.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/json/json_values.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline::commands {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t first_states = 12;  // of those that are there, with which the model is calibrated
constexpr std::size_t few_numbers = 6;    // that a line has room for
constexpr std::size_t few_json = 30;      // and an object
constexpr double large_cloud = 2e5;       // numbers: such a file is written every few seconds only
constexpr double between_clouds = 5;      // [s]
constexpr int poll_ms = 50;               // between looks for readings: delays an answer by as much

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

const char* word(identify::FilterUpdate::Fate fate) {
    switch (fate) {
        case identify::FilterUpdate::Fate::taken_in:
            return "taken in";
        case identify::FilterUpdate::Fate::held_back:
            return "held back";
        default:
            return "left out";
    }
}

std::string in_words(const identify::Alarm& alarm, const identify::MeasurementSet& set) {
    std::string text =
        fmt::format("the model no longer fits: since probe {}, {:g} s", alarm.since.probe, alarm.since.time);
    if (alarm.marker >= 0) {
        text += fmt::format(", near marker {} at ({:.4g}, {:.4g}, {:.4g}) mm, {:.2g} sigmas off",
                            identify::label_of(set.markers[alarm.marker]), alarm.at.x(), alarm.at.y(), alarm.at.z(),
                            alarm.whitened_rms);
    }
    return text;
}

class Follower {
public:
    Follower(const FollowOptions& options, const Common& common) : options_(options), common_(common) {}

    Outcome run() {
        begin();
        std::optional<SetTail> tail;
        if (options_.standard_input) {
            lines_.emplace(filter_->set(), standard_input());
        } else if (!options_.socket.empty()) {
            lines_.emplace(filter_->set(), unix_socket(options_.socket));
            Console::notice(fmt::format("Listens at {}.", options_.socket.string()));
        } else {
            tail.emplace(options_.set);
        }
        Clock::time_point last = Clock::now();
        for (;;) {
            JsonLines::Arrived arrived;
            if (lines_) {
                arrived = lines_->poll();
            } else {
                SetTail::News news = tail->poll();
                arrived = {std::move(news.states), std::move(news.faults), false};
            }
            for (const std::string& fault : arrived.faults) tell_fault(fault);
            for (const identify::LoadState& state : arrived.states) take_in(state);
            if (!arrived.states.empty()) last = Clock::now();
            if (arrived.is_over) break;
            if (options_.timeout > 0 && seconds_since(last) > options_.timeout) break;
            if (arrived.states.empty()) idle();
        }
        return end();
    }

private:
    fs::path cloud_file() const { return options_.output / "cloud.json"; }

    /// A calibration by the first states that are there, and where there is a cloud, on from it.
    void begin() {
        auto [model, set] = read_model_and_set(options_.model, options_.set);
        set = identify::label_readings(identify::with_markers_of_fields(set)).set;
        identify::require_followable(model, set);
        rest_.emplace(set.rest_surface);
        std::optional<Cloud> cloud;
        if (fs::exists(cloud_file())) cloud = read_cloud(cloud_file());
        begun_with_ = cloud ? cloud->begun_with : static_cast<int>(std::min(first_states, set.states.size()));
        if (begun_with_ < 1 || begun_with_ > static_cast<int>(set.states.size())) {
            throw InvalidInput(
                fmt::format("{}: was begun with {} states, of which the set holds {}; remove it to begin anew",
                            cloud_file().string(), begun_with_, set.states.size()));
        }
        set.states.resize(static_cast<std::size_t>(begun_with_));
        identify::Calibration calibration =
            identify::calibrate(model, identify::informative_readings(model, set), options_.how, Console::progress());
        Console::end_progress();
        filter_.emplace(model, set, std::move(calibration), options_.filter);
        if (cloud) filter_->resume(std::move(cloud->state));
        known_ = filter_->state().seen;
        Console::notice(cloud ? fmt::format("Goes on from {}, which knows {} readings.", cloud_file().string(),
                                            filter_->state().readings)
                              : fmt::format("Calibrated with the first {} readings; more are waited for.",
                                            filter_->state().readings));
    }

    void take_in(const identify::LoadState& state) {
        if (known_.erase({state.probe, state.time}) > 0) return;  // it began with that one
        try {
            identify::check_contacts(*rest_, state, lines_ ? lines_->name() : "probes.csv");
        } catch (const InvalidInput& fault) {
            return tell_fault(fault.what());
        }
        const Clock::time_point start = Clock::now();
        const identify::FilterUpdate update = filter_->assimilate(state);
        const double took = seconds_since(start);
        const std::string object = json_of(state, update, took).dump();
        if (lines_) lines_->answer(object);
        if (common_.json) {
            fmt::print("{}\n", object);
        } else {
            fmt::print("{}\n", line_of(state, update, took));
            if (update.alarm && !alarmed_) fmt::print("ALARM: {}\n", in_words(*update.alarm, filter_->set()));
            if (!update.alarm && alarmed_) fmt::print("The model fits again.\n");
        }
        std::fflush(stdout);
        alarmed_ = update.alarm.has_value();
        unsaved_ = true;
        const auto numbers = static_cast<double>(filter_->state().spectrum.vectors.size());
        if (numbers < large_cloud || seconds_since(saved_) > between_clouds) save();
    }

    void tell_fault(const std::string& fault) {
        const std::string object = nlohmann::json{{"fate", "left out"}, {"why", fault}}.dump();
        if (lines_) lines_->answer(object);
        if (common_.json) {
            fmt::print("{}\n", object);
        } else {
            fmt::print("left out: {}\n", fault);
        }
        std::fflush(stdout);
    }

    /// Time for what updates leave undone.
    void idle() {
        if (filter_->rejuvenate(common_.threads)) unsaved_ = true;
        if (unsaved_) save();
        std::this_thread::sleep_for(std::chrono::milliseconds(poll_ms));
    }

    void save() {
        write_cloud(cloud_file(), {begun_with_, filter_->state()});
        saved_ = Clock::now();
        unsaved_ = false;
    }

    std::string line_of(const identify::LoadState& state, const identify::FilterUpdate& update, double took) const {
        std::string text = fmt::format("probe {}, {:g} s: {}", state.probe, state.time, word(update.fate));
        if (!update.why.empty()) text += fmt::format(" ({})", update.why);
        if (!std::isnan(update.p_value)) {
            text += fmt::format("; forecast off by {:.3g} mm, p {:.2g}", update.error, update.p_value);
        }
        if (update.fate != identify::FilterUpdate::Fate::taken_in) return text;
        const std::vector<identify::PosteriorRow> rows = filter_->posterior();
        text += fmt::format("; {} readings, {} of {} numbers informed, {:.0f} ms", update.readings, update.informed,
                            rows.size(), 1e3 * took);
        for (std::size_t i = 0; i < rows.size() && rows.size() <= few_numbers; ++i) {
            text += fmt::format("; {} {:.4g} ± {:.2g} {}", rows[i].parameter, rows[i].mean, rows[i].sd, rows[i].unit);
        }
        return text;
    }

    nlohmann::json json_of(const identify::LoadState& state, const identify::FilterUpdate& update, double took) const {
        nlohmann::json object = {{"probe", state.probe},
                                 {"time", state.time},
                                 {"fate", word(update.fate)},
                                 {"why", update.why},
                                 {"p_value", known(update.p_value)},
                                 {"forecast_error_mm", known(update.error)},
                                 {"readings", update.readings},
                                 {"seconds", took},
                                 {"alarm", nullptr}};
        if (update.alarm) {
            const identify::Alarm& alarm = *update.alarm;
            object["alarm"] = {{"since", {{"probe", alarm.since.probe}, {"time", alarm.since.time}}},
                               {"at", {alarm.at.x(), alarm.at.y(), alarm.at.z()}},
                               {"whitened_rms", alarm.whitened_rms},
                               {"words", in_words(alarm, filter_->set())}};
        }
        if (update.fate != identify::FilterUpdate::Fate::taken_in) return object;
        object["informed"] = update.informed;
        const std::vector<identify::PosteriorRow> rows = filter_->posterior();
        for (std::size_t i = 0; i < rows.size() && rows.size() <= few_json; ++i) {
            object["posterior"][rows[i].parameter] = {{"mean", rows[i].mean}, {"sd", rows[i].sd}};
        }
        return object;
    }

    Outcome end() {
        filter_->rejuvenate(common_.threads);
        save();
        const std::vector<identify::PosteriorRow> rows = filter_->posterior();
        mesh::write_text(options_.output / "posterior.csv", posterior_csv(rows));
        std::string particles = "weight";
        for (const identify::PosteriorRow& row : rows) particles += "," + row.parameter;
        particles += "\n";
        const Eigen::MatrixXd cloud = filter_->particles();
        for (Eigen::Index i = 0; i < cloud.rows(); ++i) {
            particles += fmt::format("{:.6g}", 1.0 / static_cast<double>(cloud.rows()));
            for (const double value : cloud.row(i)) particles += fmt::format(",{:.6g}", value);
            particles += "\n";
        }
        mesh::write_text(options_.output / "particles.csv", particles);
        const fs::path model = options_.output / "model.json";
        skeleton::write_model(model, filter_->model());
        Outcome outcome;
        if (!common_.json) {
            outcome.text = fmt::format("{}: {} readings taken in. Next: palpate compare {} {}\n", model.string(),
                                       filter_->state().readings, model.string(), options_.set.string());
        }
        return outcome;
    }

    const FollowOptions& options_;
    const Common& common_;
    std::optional<identify::Filter> filter_;
    std::optional<JsonLines> lines_;  // none: another program appends to the set
    std::optional<identify::RestBody> rest_;
    std::set<identify::StateName> known_;  // of the set's states, that the filter knew when it began
    int begun_with_ = 0;
    bool alarmed_ = false, unsaved_ = true;
    Clock::time_point saved_ = Clock::now();
};

}  // namespace

Outcome follow(const FollowOptions& options, const Common& common) { return Follower(options, common).run(); }

}  // namespace palpate::pipeline::commands
