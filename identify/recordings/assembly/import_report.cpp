#include "identify/recordings/assembly/import_report.h"

#include <fmt/format.h>

#include <numbers>

namespace palpate::identify {

std::string describe(const ImportReport& report) {
    std::string text;
    for (const ProbeReport& probe : report.probes) {
        text += fmt::format("Probe {} ({}): {} points, {} channels", probe.probe, fmt::join(probe.files, ", "),
                            probe.points, probe.channels);
        if (probe.seconds > 0) text += fmt::format(", {:.4g} s", probe.seconds);
        text += fmt::format("; {} state{}.\n", probe.states, probe.states == 1 ? "" : "s");
    }
    for (const ClockReport& clock : report.clocks) {
        text += fmt::format("  {} merged {}", clock.file, clock.how);
        if (clock.sd > 0 || clock.offset != 0) text += fmt::format(": t = {:.6g} s + ", clock.offset);
        if (clock.sd > 0 || clock.offset != 0)
            text += clock.rate == 1 ? std::string("t of the file") : fmt::format("{:.8g} x t of the file", clock.rate);
        if (clock.sd > 0) text += fmt::format(", to {:.2g} ms (1 sd)", 1000 * clock.sd);
        text += ".\n";
    }
    text += fmt::format("Registered by {}", report.registered_by);
    if (report.registration && report.registration->points > 0) {
        const Registration& fit = *report.registration;
        text += fmt::format(": {:.3g} mm rms, {:.3g} mm at most", fit.rms, std::max(fit.largest, fit.rms));
        if (fit.translation_sd > 0) text += fmt::format("; place to {:.2g} mm", fit.translation_sd);
        if (fit.rotation_sd > 0)
            text += fmt::format(", turn to {:.2g} degrees (1 sd)", fit.rotation_sd * 180 / std::numbers::pi);
        if (fit.motion.scale != 1) text += fmt::format("; scale {:.5g}", fit.motion.scale);
    }
    text += ".\n";
    if (report.registration)
        for (const std::string& note : report.registration->notes) text += "  - " + note + "\n";
    for (const std::string& note : report.notes) text += "  - " + note + "\n";
    return text;
}

}  // namespace palpate::identify
