#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "pipeline/forge/drafts/kinds.h"

namespace palpate::pipeline {
namespace {

double require(const Told& told, const std::string& effect, const std::string& name, double drawn, double most) {
    const double value = told.value(name, drawn);
    if (value > 0 && value <= most) return value;
    throw InvalidInput(fmt::format("effect '{}': {} is {:g}, allowed is above 0 to {:g}", effect, name, value, most));
}

std::vector<Draft> misalignment(Drawing& drawing, const Told& told) {
    const double size = drawing.specimen.model->size();
    const Vec3 t0 = random_direction(drawing.random), w0 = random_direction(drawing.random);
    const bool is_told = told.has_any({"tx", "ty", "tz", "rx", "ry", "rz"});
    const auto at = [=](double x) {
        // A turn about the centre moves markers by about a third of the size times its angle.
        const double s = is_told ? 0 : x;
        const Vec3 t = told.vector({"tx", "ty", "tz"}, s * size * t0), w = told.vector({"rx", "ry", "rz"}, 3 * s * w0);
        return told.effect({{"tx", t.x()}, {"ty", t.y()}, {"tz", t.z()}, {"rx", w.x()}, {"ry", w.y()}, {"rz", w.z()}});
    };
    return {{.at = at, .start = 0.005, .most = 0.2, .is_told = is_told}};
}

std::vector<Draft> force_gain(Drawing& drawing, const Told& told) {
    if (drawing.plan.courses.size() < 3) {
        throw InvalidInput("effect 'force-gain' is of every second probe: ask for two probes at least");
    }
    constexpr double most = 100;
    require(told, "force-gain", "gain", 1, most);
    const double sign = drawing.random.uniform() < 0.5 ? -1 : 1;
    const auto at = [=](double x) { return told.effect({{"gain", std::exp(sign * x)}}); };
    return {{.at = at, .start = 0.3, .most = std::log(4.0), .is_told = told.has("gain")}};
}

std::vector<Draft> outliers(Drawing&, const Told& told) {
    const double share = require(told, "outliers", "share", 0.06, 0.5);
    require(told, "outliers", "width", 1, 1e6);
    const auto at = [=](double x) { return told.effect({{"share", share}, {"width", x}}); };
    return {{.at = at, .start = 25, .is_told = told.has("width")}};
}

}  // namespace

const std::vector<DraftKind>& measurement_kinds() {
    static const std::vector<DraftKind> kinds{
        {"misalignment",
         misalignment,
         {{"tx", "mm"}, {"ty", "mm"}, {"tz", "mm"}, {"rx", "rad"}, {"ry", "rad"}, {"rz", "rad"}}},
        {"force-gain", force_gain, {{"gain", "1"}}},
        {"outliers", outliers, {{"share", "1"}, {"width", "1"}}},
    };
    return kinds;
}

}  // namespace palpate::pipeline
