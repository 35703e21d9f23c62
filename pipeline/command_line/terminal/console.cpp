#include "pipeline/command_line/terminal/console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>

#include "pipeline/command_line/terminal/listener.h"
#include "pipeline/command_line/terminal/printed_units.h"

namespace palpate::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

bool on_terminal() { return isatty(STDERR_FILENO) != 0; }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr auto redrawn_every = std::chrono::seconds(1);

/// What is left of a piece of work by how long a share of it took; "" where that tells little.
std::string time_left(double elapsed, double done, double since_last) {
    constexpr double too_early = 0.05, too_late = 0.95, least = 2;  // shares, and seconds
    if (done < too_early || done > too_late) return {};
    const double left = elapsed * (1 - done) / done - since_last;
    if (left < least) return {};  // none is told rather than none left
    constexpr double minute = 60;
    return left < 2 * minute ? fmt::format(", about {:.0f} s left", left)
                             : fmt::format(", about {:.0f} min left", left / minute);
}

/// A bar on the last line of a terminal, one step at a time: a new name starts a new step. Seconds go on while a step
/// says nothing.
class ProgressBar {
public:
    ~ProgressBar() { stop(); }

    void tell(std::string_view what, double fraction) {
        const std::lock_guard guard(mutex_);
        if (what != what_) {
            what_ = what;
            start_ = Clock::now();
            begun_ = std::clamp(fraction, 0.0, 1.0);
        }
        last_ = Clock::now();
        done_ = std::clamp(fraction, 0.0, 1.0);
        if (done_ >= 1) {
            erase();
            return;
        }
        draw();
        if (!ticker_.joinable()) ticker_ = std::jthread([this](const std::stop_token& stop) { tick(stop); });
    }

    /// Prints where the bar stands, which is gone until the next second.
    template <typename Print>
    void give_way(Print&& print) {
        const std::lock_guard guard(mutex_);
        erase();
        print();
    }

    void stop() {
        if (ticker_.joinable()) {
            ticker_.request_stop();
            woken_.notify_all();
            ticker_.join();
        }
        const std::lock_guard guard(mutex_);
        erase();
    }

private:
    void tick(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            woken_.wait_for(lock, stop, redrawn_every, [] { return false; });
            if (!stop.stop_requested() && done_ < 1 && !what_.empty()) draw();
        }
    }

    void draw() {
        const double elapsed = seconds_since(start_), share = begun_ < 1 ? (done_ - begun_) / (1 - begun_) : 1;
        fmt::print(stderr, "\r\033[K{}",
                   progress_line(what_, done_, elapsed, time_left(elapsed, share, seconds_since(last_)), columns()));
        std::fflush(stderr);
        is_shown_ = true;
    }

    /// As much as one line of the terminal takes: a longer one would not be erased.
    static std::size_t columns() {
        winsize size{};
        const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
        return is_known ? size.ws_col - 1U : 79U;
    }

    void erase() {
        if (!is_shown_) return;
        fmt::print(stderr, "\r\033[K");
        std::fflush(stderr);
        is_shown_ = false;
    }

    std::mutex mutex_;
    std::condition_variable_any woken_;
    std::string what_;
    double done_ = 1, begun_ = 0;  // where the step began
    bool is_shown_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_;
    std::jthread ticker_;
};

ProgressBar& bar() {
    static ProgressBar the_bar;
    return the_bar;
}

/// Where there is no terminal: a line every ten seconds of the step that goes on, whether it says anything or not.
class ProgressLines {
public:
    ~ProgressLines() { stop(); }

    void tell(std::string_view what, double fraction) {
        const std::lock_guard guard(mutex_);
        if (what != what_) {
            what_ = what;
            start_ = Clock::now();
        }
        done_ = std::clamp(fraction, 0.0, 1.0);
        if (!ticker_.joinable()) ticker_ = std::jthread([this](const std::stop_token& stop) { tick(stop); });
    }

    /// The step is over, or was left.
    void rest() {
        const std::lock_guard guard(mutex_);
        what_.clear();
    }

    void stop() {
        if (!ticker_.joinable()) return;
        ticker_.request_stop();
        woken_.notify_all();
        ticker_.join();
        ticker_ = {};
    }

private:
    void tick(const std::stop_token& stop) {
        constexpr auto often = std::chrono::seconds(10);
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            woken_.wait_for(lock, stop, often, [] { return false; });
            if (stop.stop_requested() || what_.empty() || done_ >= 1) continue;
            spdlog::info("{}: {:.0f} %, {:.0f} s", what_, 100 * done_, seconds_since(start_));
        }
    }

    std::mutex mutex_;
    std::condition_variable_any woken_;
    std::string what_;
    double done_ = 1;
    Clock::time_point start_ = Clock::now();
    std::jthread ticker_;
};

ProgressLines& progress_lines() {
    static ProgressLines the_lines;
    return the_lines;
}

/// Of this thread; null: standard error.
const Listener*& listener() {
    static thread_local const Listener* in_this_thread = nullptr;
    return in_this_thread;
}

template <typename Print>
void aloud(Importance importance, const std::string& text, Print&& print) {
    if (listener()) {
        listener()->message(importance, text);
        return;
    }
    if (on_terminal())
        bar().give_way(print);
    else
        print();
}

}  // namespace

Listening::Listening(const Listener& to) : before_(listener()) { listener() = &to; }
Listening::~Listening() { listener() = before_; }

void Console::set_up(Verbosity verbosity) {
    const bool colours = on_terminal() && std::getenv("NO_COLOR") == nullptr;
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(colours ? spdlog::color_mode::automatic
                                                                              : spdlog::color_mode::never);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("palpate", sink));
    spdlog::set_pattern("%^%v%$");
    spdlog::set_level(verbosity == Verbosity::quiet     ? spdlog::level::err
                      : verbosity == Verbosity::verbose ? spdlog::level::debug
                                                        : spdlog::level::info);
}

void Console::notice(const std::string& text) {
    aloud(Importance::notice, text, [&] { spdlog::info("{}", with_printed_units(text)); });
}
void Console::notices(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) notice(text);
}
void Console::warning(const std::string& text) {
    aloud(Importance::warning, text, [&] { spdlog::warn("warning: {}", with_printed_units(text)); });
}
void Console::error(const std::string& text) {
    aloud(Importance::error, text, [&] { spdlog::error("error: {}", with_printed_units(text)); });
}
void Console::detail(const std::string& text) {
    aloud(Importance::detail, text, [&] { spdlog::debug("{}", text); });
}

Progress Console::progress() {
    if (listener()) return listener()->progress;
    if (!spdlog::should_log(spdlog::level::info)) return {};
    if (on_terminal()) return [](std::string_view what, double fraction) { bar().tell(what, fraction); };
    // When nobody holds it any more, the step that it told of is over.
    const std::shared_ptr<ProgressLines> told(&progress_lines(), [](ProgressLines* all) { all->rest(); });
    return [told](std::string_view what, double fraction) { told->tell(what, fraction); };
}

void Console::end_progress() {
    if (on_terminal())
        bar().stop();
    else
        progress_lines().stop();
}

std::string progress_line(const std::string& what, double done, double elapsed, const std::string& left,
                          std::size_t columns) {
    constexpr std::size_t widest = 24, narrowest = 4, frame = 3;  // of the bar; its brackets and a space
    std::string tail = fmt::format(" {:.0f} %, {:.0f} s", 100 * done, elapsed);
    if (what.size() + tail.size() + left.size() <= columns) tail += left;
    const std::string name = what.substr(0, columns - std::min(columns, tail.size()));
    const std::size_t room = columns - std::min(columns, name.size() + tail.size());
    if (room < narrowest + frame) return (name + tail).substr(0, columns);
    const std::size_t width = std::min(widest, room - frame);
    const std::string filled(static_cast<std::size_t>(done * static_cast<double>(width)), '=');
    return fmt::format("{} [{:<{}}]{}", name, filled, width, tail);
}

}  // namespace palpate::pipeline
