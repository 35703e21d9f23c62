#include "pipeline/run/stages/sphere_curve.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/results/quality.h"
#include "pipeline/run/folder/report_stage.h"

namespace palpate::pipeline::commands {
namespace {

using nlohmann::json;

constexpr const char* curve_stage = "sphere_curve";
constexpr const char* curve_file = "skeleton/sphere_curve.json";

QualityOptions how_to_measure(const skeleton::Model& model, const Common& common) {
    const auto free = static_cast<int>(std::ranges::count(model.spheres, false, &skeleton::Sphere::held));
    QualityOptions options;
    options.spheres.clear();
    for (const int count : {free / 4, free / 2, 2 * free}) {
        if (count >= 1) options.spheres.push_back(count);
    }
    options.threads = common.threads;
    return options;
}

std::string in_words(const json& steps) {
    std::string words;
    for (const json& step : steps) {
        words += fmt::format("{}{:.3g} % with {}", words.empty() ? "" : ", ", 100 * step["error"]["rms"].get<double>(),
                             step["spheres"].get<int>());
    }
    return words + " free spheres";
}

}  // namespace

void measure_sphere_curve(RunFolder& folder, const Subject& subject, const MeshedBody& body,
                          const skeleton::Model& model, const Common& common) {
    if (!subject.settings.sphere_curve || subject.settings.model) {
        folder.drop(curve_stage, {curve_file});
        return;
    }
    try {
        const bool ran = folder.stage(
            {curve_stage, {{"seed", subject.settings.identify.seed}}, {}, {"mesh", "skeleton"}, {curve_file}}, [&] {
                const Quality quality =
                    measure_quality(subject, body, model, how_to_measure(model, common), Console::progress());
                mesh::write_text(folder.path() / curve_file, quality_json(quality).dump(1) + "\n");
                return json{{"rungs", quality.steps.size()}};
            });
        report_stage(folder, curve_stage, ran,
                     in_words(json::parse(mesh::read_text(folder.path() / curve_file))["rungs"]));
        return;
    } catch (const InvalidInput& e) {
        Console::warning(std::string("The effect of more spheres was not measured: ") + e.what());
    } catch (const SolverFailure& e) {
        Console::warning(std::string("The effect of more spheres was not measured: ") + e.what());
    }
    folder.drop(curve_stage, {curve_file});
}

}  // namespace palpate::pipeline::commands
