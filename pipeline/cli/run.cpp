#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/subcommands.h"

namespace palpate::pipeline {

void Subcommands::add_run(CLI::App& app) {
    auto* sub = subcommand(
        app, "run", "The whole pipeline: mesh, skeleton, identification, comparison, diagnosis, improvement, report.",
        "  palpate run liver.stl --longest 200\n"
        "  palpate run my-measurements/ -o result\n"
        "  palpate run case.yaml\n",
        [this] {
            if (run.output.empty()) {
                run.output =
                    std::filesystem::path(std::filesystem::weakly_canonical(run.input).stem().string() + "-run");
            }
            run.overrides.seed = common.seed;
            return commands::run(run, common);
        });
    sub->add_option("INPUT", run.input, "A case.yaml, a measurement set (folder or set.yaml), or a mesh")->required();
    sub->add_option("-o,--output", run.output, "The run folder; <input>-run by default");
    for (const char* group : {"Body", "Skeleton", "Sphere curve", "Probing", "Identification", "Diagnosis"})
        add_flags_of(sub, run.overrides, group);
}

}  // namespace palpate::pipeline
