#pragma once

#include <memory>

#include "identify/comparison/comparison.h"
#include "identify/diagnosis/ladder/ladder.h"
#include "identify/inference/identify_result.h"
#include "pipeline/body/body.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "skeleton/construction/build.h"

// What the commands of these names do between reading files and writing them: for them, and for other programs. Files
// that the options name are neither read nor written here, but for the case, the mesh, and missing.pvd of a diagnosis.

namespace palpate::pipeline::commands {

struct BuiltBody {
    Subject subject;
    MeshedBody body;
};
BuiltBody build_body(const std::filesystem::path& input, const CaseOverrides& overrides);

struct BuiltSkeleton {
    skeleton::Model model;
    skeleton::BuildReport report;
};
BuiltSkeleton build_skeleton(const BuiltBody& from);

identify::IdentifyResult identify(const ModelAndSet& given, const CaseOverrides& overrides, const Common& common);

struct Compared {
    identify::MeasurementSet set;  // as the model understands it
    identify::Comparison comparison;
    nlohmann::json json;  // compare.json
};
Compared compare(const ModelAndSet& given, const CompareOptions& options, const Common& common);

struct Diagnosed {
    nlohmann::json json;  // diagnosis.json
    std::vector<std::string> explanation, notes;
    std::filesystem::path regions =
        {};  // folder of the set with the parts of a map as regions; empty: none was written
};
Diagnosed diagnose(const ModelAndSet& given, const DiagnoseCommandOptions& options, const Common& common);

struct Improved {
    identify::Ladder ladder;
    std::unique_ptr<identify::BodyModel> body;  // that it was built on
};
Improved improve(const ModelAndSet& given, const ImproveCommandOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
