#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/analysis/quality/convergence_study.h"
#include "pipeline/case/settings/overrides.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/command_line/terminal/outcome.h"
#include "pipeline/run/run.h"
#include "pipeline/synthesis/options.h"

// Each command with its options; that of `run` is in run/run.h.

namespace palpate::pipeline::commands {

struct CheckOptions {
    std::filesystem::path input;
    std::filesystem::path output = {};       // a folder, or a page (.html); none: nothing is written
    std::vector<std::string> expected = {};  // effects that the set has to be able to show
    bool cost = false;                       // tell what a run would take
    CaseOverrides overrides;
};
Outcome check(const CheckOptions& options, const Common& common);

struct MeshOptions {
    std::filesystem::path input, output;
    std::string format = {};  // vtu, inp, msh or msh22; empty: what the output's name says
    CaseOverrides overrides;
};
Outcome mesh_body(const MeshOptions& options, const Common& common);

struct SkeletonOptions {
    std::filesystem::path input, output;
    CaseOverrides overrides;
    std::optional<QualityOptions> quality = {};  // absent: it is not measured
};
Outcome skeleton(const SkeletonOptions& options, const Common& common);

struct ProbeCommandOptions {
    std::filesystem::path input, output;
    CaseOverrides overrides;
    BlindSetOptions synthesis = {};
    std::vector<std::string> regions = {};  // NAME:surface=FILE,young=MPA,... each
    std::filesystem::path from = {};        // folder of another solver's results; empty: our own finite elements
    std::string array = {};                 // of displacements in those; empty: found by its name
    std::string to = {};                    // "inp": what is to be computed, for another solver; empty: it is computed
};
Outcome probe(const ProbeCommandOptions& options, const Common& common);

struct IdentifyCommandOptions {
    std::filesystem::path model, set, output;
    CaseOverrides overrides;
};
Outcome identify(const IdentifyCommandOptions& options, const Common& common);

struct CompareOptions {
    std::filesystem::path model, set, output;
    std::optional<double> tolerance;  // [mm]
    bool no_reference = false;        // the skeleton alone: fast, and without an error budget
    CaseOverrides overrides = {};
};
Outcome compare(const CompareOptions& options, const Common& common);

struct DiagnoseCommandOptions {
    std::filesystem::path model, set, output;
    std::vector<std::string> without = {};  // effects left out of the catalogue
    std::string body = "reference";         // or "skeleton": what the errors are judged on
    CaseOverrides overrides = {};
};
Outcome diagnose(const DiagnoseCommandOptions& options, const Common& common);

struct ImproveCommandOptions {
    std::filesystem::path model, set, output;
    std::vector<std::string> add = {};  // effects, EFFECT[:name=value,...], a step each; from these values
    bool automatic = false;             // what a diagnosis names, in place of those
    bool residual = false;              // the same, and what is left then, located
    std::filesystem::path draft = {};   // C++ file for that as an effect of one's own
    std::string body = {};              // as for a diagnosis; empty: the skeleton where an effect is of its links alone
    CaseOverrides overrides = {};
};
Outcome improve(const ImproveCommandOptions& options, const Common& common);

struct EffectsOptions {
    std::string name;  // empty: all
};
Outcome effects(const EffectsOptions& options, const Common& common);

struct SimulateOptions {
    std::filesystem::path model, probes, output;
    std::optional<double> dt = {}, duration = {};  // motion, a frame every dt [s]; absent: equilibria
    std::optional<double> damping = {};            // ratio of the softest mode [-]; none: the model's, or 0.1
    bool implicit = false;                         // a step a frame, stable at any size, in place of small ones
    std::filesystem::path posterior = {};          // folder of particles.csv; empty: the model's own, if there is one
    int draws = 32;                                // from it, for intervals of equilibria; 0: none
    std::vector<std::string> add = {};             // effects besides the model's own, EFFECT:name=value,...
    std::filesystem::path markers = {};            // markers.csv, whose positions are written; empty: the skin's
};
Outcome simulate(const SimulateOptions& options, const Common& common);

struct ExportOptions {
    std::filesystem::path model, output;
    std::string to;                 // gltf, sofa, chai3d, stl, vtp
    std::filesystem::path probes;   // empty: the body at rest
    std::optional<int> state = {};  // of the probes' states; absent: the last, and all of them as gltf's animation
};
Outcome export_model(const ExportOptions& options, const Common& common);

struct ReportOptions {
    std::vector<std::filesystem::path> runs;  // several: side by side on one page
    std::filesystem::path output;             // empty: report.html in the run folder, of one
};
Outcome report(const ReportOptions& options, const Common& common);

struct PoolOptions {
    std::vector<std::filesystem::path> runs;
    std::filesystem::path output;  // empty: nothing is written
};
Outcome pool(const PoolOptions& options, const Common& common);

struct PlayOptions {
    std::filesystem::path input, output;  // no output: it is served
    std::filesystem::path set = {};       // measurements; empty: the run's own, where it has some
    int port = 0;                         // 0: a free one
    bool pick = false;                    // `input` is a mesh, a case or a set, on which places are chosen
    CaseOverrides overrides = {};         // of that
};
/// A page in which the model is touched, or a body is set up. @throws InvalidInput, IoError.
Outcome play(const PlayOptions& options, const Common& common);

struct NewOptions {
    std::filesystem::path folder;
    std::string rig = {};       // indenter, tensile, pneumatic, tendon: a measurement set; empty: a case
    bool measurements = false;  // an empty set to fill in, in place of a case
};
/// A commented case.yaml or measurement set, and a small body to try it on. @throws InvalidInput when the folder is
/// there and not empty.
Outcome new_case(const NewOptions& options, const Common& common);

struct InfoOptions {
    std::filesystem::path file;
};
Outcome info(const InfoOptions& options, const Common& common);

}  // namespace palpate::pipeline::commands
