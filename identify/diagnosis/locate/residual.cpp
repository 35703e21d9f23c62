#include "identify/diagnosis/locate/residual.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/diagnosis/locate/locate.h"

namespace palpate::identify {
namespace {

/// The effect that a source is; "": models have none for it.
const char* effect_of(const SourceTerm& term) {
    const bool is_constant = term.law == SourceLaw::constant;
    switch (term.form) {
        case SourceForm::force:
        case SourceForm::traction:
            return is_constant ? "local-force" : "";
        case SourceForm::normal:
            if (term.law == SourceLaw::spring) return "local-springs";
            return is_constant ? "local-force" : "";
        case SourceForm::softening:
            return is_constant && std::isfinite(term.radius) ? "inclusion" : "";
        default:
            return "";
    }
}

void tell_vector(const std::array<const char*, 3>& names, const Vec3& v, const char* unit,
                 skeleton::EffectRecord& effect) {
    for (int a = 0; a < 3; ++a) effect.parameters.push_back({names[a], v[a], unit});
}

skeleton::EffectRecord record_of(const SourceTerm& term, double size) {
    skeleton::EffectRecord effect{effect_of(term), {}};
    tell_vector({"cx", "cy", "cz"}, term.centre, "mm", effect);
    const double sd = std::min(term.radius, size);
    if (effect.name == "inclusion") {
        // The ball whose points are as far from its middle, rms: 3/5 R^2 = 3 sd^2. First order tells of a large change
        // only that it is large.
        const double most = std::log(8.0);
        effect.parameters.push_back({"radius", std::sqrt(5.0) * sd, "mm"});
        effect.parameters.push_back({"ratio", std::exp(std::clamp(term.mean[0], -most, most)), "1"});
        return effect;
    }
    effect.parameters.push_back({"radius", sd, "mm"});
    if (effect.name == "local-springs") {
        effect.parameters.push_back({"stiffness", term.mean[0], "N/mm"});
    } else {
        const Vec3 force = term.form == SourceForm::normal ? Vec3(term.mean[0] * term.axis) : Vec3(term.mean.head<3>());
        tell_vector({"fx", "fy", "fz"}, force, "N", effect);
    }
    return effect;
}

}  // namespace

std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis, int threads) {
    const auto can_be_shown = [&](const SourceTerm& term) {
        const std::string effect = effect_of(term);
        const bool is_sensible = effect != "local-springs" || term.mean[0] > 0;
        return !effect.empty() && is_sensible &&
               std::ranges::find(diagnosis.explanation, effect) == diagnosis.explanation.end();
    };
    const std::optional<MissingSource> source =
        locate_missing(model, diagnosis.problem, diagnosis.best(), threads, can_be_shown);
    if (!source || !(source->log_bayes_factor() > 0)) return std::nullopt;
    return Residual{record_of(source->likeliest(), model.size()), source->log_bayes_factor()};
}

}  // namespace palpate::identify
