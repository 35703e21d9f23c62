#include "pipeline/command_line/console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>

namespace palpate::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

bool on_terminal() { return isatty(STDERR_FILENO) != 0; }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One step at a time: a new name starts a new step.
class ProgressPrinter {
public:
    void tell(std::string_view what, double fraction) {
        if (what != what_) begin(what);
        const double done = std::clamp(fraction, 0.0, 1.0);
        if (on_terminal()) {
            draw_bar(done);
        } else if (seconds_since(last_line_) > 10.0) {
            last_line_ = Clock::now();
            spdlog::info("{}: {:.0f} %", what_, 100 * done);
        }
    }

private:
    void begin(std::string_view what) {
        what_ = what;
        start_ = last_line_ = Clock::now();
    }

    void draw_bar(double done) const {
        constexpr int width = 30;
        const auto filled = static_cast<int>(done * width);
        const double elapsed = seconds_since(start_);
        const std::string left =
            done > 0.02 && done < 1 ? fmt::format("{:4.0f} s left", elapsed * (1 - done) / done) : std::string(11, ' ');
        fmt::print(stderr, "\r{:<28.28} [{:<{}}] {:3.0f} % {}", what_,
                   std::string(static_cast<std::size_t>(filled), '='), width, 100 * done, left);
        if (done >= 1) fmt::print(stderr, "\r{}\r", std::string(79, ' '));
        std::fflush(stderr);
    }

    std::string what_;
    Clock::time_point start_ = Clock::now(), last_line_ = start_;
};

}  // namespace

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

void Console::notice(const std::string& text) { spdlog::info("{}", text); }
void Console::notices(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) notice(text);
}
void Console::warning(const std::string& text) { spdlog::warn("warning: {}", text); }
void Console::error(const std::string& text) { spdlog::error("error: {}", text); }
void Console::detail(const std::string& text) { spdlog::debug("{}", text); }

Progress Console::progress() {
    if (!spdlog::should_log(spdlog::level::info)) return {};
    auto printer = std::make_shared<ProgressPrinter>();
    return [printer](std::string_view what, double fraction) { printer->tell(what, fraction); };
}

}  // namespace palpate::pipeline
