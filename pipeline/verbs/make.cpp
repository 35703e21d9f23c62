#include "pipeline/verbs/flags.h"
#include "pipeline/verbs/verbs.h"

// Verbs that make something from a mesh or a set.

namespace palpate::pipeline {

void Verbs::add_run(CLI::App& app) {
    auto* sub = verb(
        app, "run", "The whole pipeline: mesh, skeleton, identification, comparison, diagnosis, improvement, report.",
        "  palpate run liver.stl --longest 200\n"
        "  palpate run my-measurements/ -o result\n"
        "  palpate run case.yaml\n",
        [this] {
            if (run.output.empty()) {
                run.output =
                    std::filesystem::path(std::filesystem::weakly_canonical(run.input).stem().string() + "-run");
            }
            if (common.seed) run.say.set("seed", static_cast<double>(*common.seed));
            return commands::run(run, common);
        });
    sub->add_option("INPUT", run.input, "A case.yaml, a measurement set (folder or set.yaml), or a mesh")->required();
    sub->add_option("-o,--output", run.output, "The run folder; <input>-run by default");
    for (const char* group : {"Body", "Skeleton", "Probing", "Identification", "Diagnosis"})
        add_flags_of(sub, run.say, group);
}

void Verbs::add_check(CLI::App& app) {
    auto* sub = verb(app, "check", "Reads everything, repairs nothing, says what is wrong.",
                     "  palpate check liver.stl\n  palpate check liver.stl -o liver-check\n  palpate check "
                     "my-measurements/ --json\n",
                     [this] { return commands::check(check, common); });
    sub->add_option("INPUT", check.input, "A case.yaml, a measurement set, or a mesh")->required();
    sub->add_option("-o,--output", check.output, "A folder for the report, and for files that show where faults are");
    add_flags_of(sub, check.say, "Body");
}

void Verbs::add_mesh(CLI::App& app) {
    auto* sub =
        verb(app, "mesh", "Repairs, remeshes and fills a surface with tetrahedra.",
             "  palpate mesh liver.stl -o body.vtu --edge-length 8\n  palpate mesh liver.nii.gz --label 3 --to inp\n",
             [this] { return commands::mesh_body(mesh, common); });
    sub->add_option("SURFACE", mesh.input, "A mesh, CAD, a label image, or a case.yaml")->required();
    sub->add_option("-o,--output", mesh.output, "The volume mesh; body.vtu by default");
    sub->add_option("--to", mesh.format,
                    "vtu; inp: Abaqus, CalculiX; msh, msh22: Gmsh 4.1, 2.2; by the output's name by default")
        ->check(CLI::IsMember({"vtu", "inp", "msh", "msh22"}));
    add_flags_of(sub, mesh.say, "Body");
}

void Verbs::add_skeleton(CLI::App& app) {
    auto* sub = verb(app, "skeleton", "Medial axis, spheres, links and skin, with start stiffness from the sections.",
                     "  palpate skeleton liver.stl -o model.json\n  palpate skeleton finger.stl --spheres 12\n"
                     "  palpate skeleton liver.stl -o model.json --quality --quality-spheres 16,64,256\n",
                     [this] {
                         if (with_quality) skeleton.quality = quality;
                         return commands::skeleton(skeleton, common);
                     });
    sub->add_option("INPUT", skeleton.input, "A mesh, a case.yaml, or a measurement set")->required();
    sub->add_option("-o,--output", skeleton.output, "The model; model.json by default");
    add_flags_of(sub, skeleton.say, "Body");
    for (const char* place : {"skeleton.spheres", "skeleton.coverage", "skeleton.links", "skeleton.zones"})
        add_flag(sub, skeleton.say, place);
    auto* measured = sub->add_flag("--quality", with_quality,
                                   "Measures how well skeletons follow the body, at several numbers of spheres")
                         ->group("Quality");
    sub->add_option("--quality-spheres", quality.spheres, "These numbers, in place of 8,16,32,64,128,256,512")
        ->delimiter(',')
        ->check(CLI::Range(1, skeleton::BuildOptions::most_spheres))
        ->needs(measured)
        ->group("Quality");
    sub->add_option("--quality-probes", quality.fit, "Probes that are fitted to; 12 more judge")
        ->check(CLI::Range(1, 1000))
        ->needs(measured)
        ->group("Quality");
}

void Verbs::add_report(CLI::App& app) {
    auto* sub = verb(app, "report", "A run as one self-contained page.", "  palpate report liver-run -o report.html\n",
                     [this] { return commands::report(report, common); });
    sub->add_option("RUN", report.run, "The run folder")->required();
    sub->add_option("-o,--output", report.output, "The page; report.html in the run folder by default");
}

}  // namespace palpate::pipeline
