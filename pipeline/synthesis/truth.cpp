#include "pipeline/synthesis/truth.h"

#include <cmath>

namespace palpate::pipeline {
namespace {

using nlohmann::json;

json parameters_of(const skeleton::EffectRecord& effect) {
    json parameters = json::object();
    for (const auto& [name, value, unit] : effect.parameters) parameters[name] = {{"value", value}, {"unit", unit}};
    return parameters;
}

json regions_of(const Specimen& specimen) {
    json regions = json::array();
    for (const mesh::MaterialRegion& region : specimen.set.regions) {
        const double density = region.density.value_or(specimen.material->density);
        regions.push_back({{"name", region.name},
                           {"young_mpa", region.young.value()},
                           {"poisson", region.poisson.value_or(specimen.material->poisson)},
                           {"density_kg_m3", std::round(1e6 * density / fem::tonne_per_mm3) / 1e6}});
    }
    return regions;
}

}  // namespace

json truth_of(const BlindSet& blind_set, const Specimen& specimen, const BlindSetOptions& options, std::uint64_t seed) {
    const std::string unit = options.rig.markers ? "mm" : "n";
    const std::string change = "change_rms_" + unit, beyond = "beyond_stiffness_rms_" + unit;
    json effects = json::array(), hide = json::array();
    for (const HiddenEffect& hidden : blind_set.hidden) {
        const bool of_body = skeleton::is_body_effect(hidden.effect.name);
        effects.push_back({{"effect", hidden.effect.name},
                           {"kind", of_body ? "body" : "measurement"},
                           {"parameters", parameters_of(hidden.effect)},
                           {change, hidden.strength.change},
                           {beyond, hidden.strength.beyond}});
        hide.push_back(to_spec(hidden.effect));
    }
    json truth = {{"format", "palpate-truth/1"},
                  {"body", specimen.is_skeleton() ? "skeleton" : "finite elements"},
                  {"law", specimen.law()},
                  {"material", nullptr},
                  {"noise_" + unit, blind_set.noise},
                  {"missing", options.missing},
                  {"unlabelled", options.unlabelled},
                  {"seed", seed},
                  {"effects", effects},
                  {"hide", hide},
                  {options.rig.markers ? "displacement_rms_mm" : "force_rms_n", blind_set.strength.displacement},
                  {change, blind_set.strength.change},
                  {beyond, blind_set.strength.beyond}};
    if (!specimen.set.regions.empty()) truth["regions"] = regions_of(specimen);
    if (specimen.material) {
        const fem::Material& m = *specimen.material;
        truth["material"] = {{"young_mpa", m.young},
                             {"poisson", m.poisson},
                             {"density_kg_m3", std::round(1e6 * m.density / fem::tonne_per_mm3) / 1e6}};
    }
    return truth;
}

}  // namespace palpate::pipeline
