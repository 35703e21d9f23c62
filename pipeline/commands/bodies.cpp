#include "pipeline/commands/bodies.h"

#include <fmt/format.h>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/io/region_yaml.h"
#include "pipeline/case/subject.h"
#include "pipeline/reference/reference_body.h"
#include "skeleton/model_io.h"

namespace palpate::pipeline::commands {

ModelAndSet read_model_and_set(const std::filesystem::path& model, const std::filesystem::path& set) {
    ModelAndSet read{skeleton::read_model(model), read_measurements(set)};
    if (mesh::regions_to_yaml(read.model.supports) != mesh::regions_to_yaml(read.set.supports)) {
        Console::notice("The model and the set give different supports: the set's are taken.");
        read.model.supports = read.set.supports;
        for (skeleton::Sphere& sphere : read.model.spheres) {
            sphere.held = mesh::contains(read.set.supports, sphere.center);
        }
    }
    return read;
}

identify::MeasurementSet understood(const identify::MeasurementSet& set, const std::vector<skeleton::Effect>& effects) {
    identify::MeasurementSet result = set;
    for (const skeleton::Effect& effect : effects) {
        if (skeleton::is_body_effect(effect.name)) continue;
        result = identify::find_effect(effect.name)->corrected(result, effect);
        Console::notice(fmt::format("The model records a fault of the measurement: {}. It is taken off the readings.",
                                    effect.name));
    }
    return result;
}

std::unique_ptr<identify::ReferenceBody> reference_of(const identify::MeasurementSet& set, double edge_length) {
    Reference reference = make_reference(set, edge_length, Console::progress());
    Console::notices(reference.notes);
    if (!reference.body) {
        throw InvalidInput("the body cannot be made of finite elements: " + reference.why_none);
    }
    return std::move(reference.body);
}

identify::DiagnoseOptions diagnose_options(const skeleton::Model& model, const Common& common) {
    identify::DiagnoseOptions options;
    options.known = model.effects;
    options.refit.threads = common.threads;
    return options;
}

}  // namespace palpate::pipeline::commands
