// Measurement sets with something hidden in them, on bodies and probe plans drawn at random, for diagnosis_bench.
// Usage: blind_set_bench OUT [--sets N] [--seed N] [--jobs N] [--repeats N] [--coarser FACTOR] [--thin] [--tool]
//                        [EFFECT[+EFFECT] ...]
// Without names: each effect of a solid in turn, nothing among them. OUT/truth.csv tells them all,
// OUT/truth/<set>.json their numbers.
// --repeats N reads each body in which nothing is hidden N times, with other noise; --coarser makes elements so much
// longer, for many sets in little time; --tool presses a ball in, a fifth as wide as the body is thick, at eight places
// to 2 and 4 % of the longest side, in place of forces, and reads its force beside the markers. Bodies, with --thin and
// without: blind_set/bodies.h.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include <iostream>
#include <mutex>
#include <random>
#include <sstream>

#include "blind_set/bodies.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/synthesis/truth.h"

using namespace palpate;

namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path out;
    int sets = 26;
    std::uint64_t seed = 1;
    int jobs = 1, repeats = 1;
    double coarser = 1;
    bool thin = false, tool = false;
    std::vector<std::string> hide{"none",    "gravity",    "stiffening",        "anisotropy", "inclusion",
                                  "contact", "prestress",  "compliant-support", "viscosity",  "plasticity",
                                  "none",    "force-gain", "misalignment"};
};

/// A ball for that body, and how deep it is pressed.
pipeline::RigOptions tool_for(const mesh::Surface& body) {
    const double longest = mesh::bounding_box(body.vertices).longest_side();
    const double thickness = std::sqrt(mesh::signed_volume(body) / longest);
    return {.tool = fmt::format("sphere:radius={:.3g}", 0.2 * thickness), .depth = {0.02 * longest, 0.04 * longest}};
}

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> words;
    std::stringstream in(text);
    for (std::string word; std::getline(in, word, at);) words.push_back(word);
    return words;
}

/// Rows of truth.csv for a body, and a line for who waits.
struct Drawn {
    std::string rows, line;
};

/// The set read once more, with noise of its own [mm].
identify::MeasurementSet with_noise(identify::MeasurementSet set, double sigma, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, sigma);
    set.position_noise = sigma;
    for (identify::LoadState& state : set.states) {
        for (identify::Reading& reading : state.readings) {
            for (int axis = 0; axis < 3; ++axis) reading.position[axis] += noise(random);
        }
    }
    return set;
}

/// Body i with what is hidden in it, written to a folder; where nothing is, as often as asked for with other noise.
Drawn draw(const Options& options, int i) {
    const std::string& hidden = options.hide[static_cast<std::size_t>(i) % options.hide.size()];
    const std::string name = fmt::format("{:03}-{}", i, hidden);
    constexpr std::uint64_t most_sets = 100003;  // of one seed: no other seed draws the same bodies
    const std::uint64_t seed = options.seed * most_sets + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    try {
        const fs::path file = write_case(options.out / "bodies" / name, options.thin, random);
        pipeline::Subject subject = pipeline::read_subject(pipeline::read_case(file));
        if (options.coarser != 1)
            subject.settings.edge_length = 0.8 * options.coarser * pipeline::reference_edge_length(subject.surface);
        pipeline::BlindSetOptions how;
        how.hide = split(hidden, '+');
        const bool repeated = hidden == "none" && options.repeats > 1;
        if (repeated) how.noise = 0;
        pipeline::ProbeOptions& probing = subject.settings.probing;
        probing.probes = options.tool ? 8 : 12;
        if (options.tool) how.rig = tool_for(subject.surface);
        probing.markers = 80;
        probing.held_out = 0;
        const pipeline::Specimen specimen = pipeline::finite_element_specimen(subject, how, {});
        pipeline::BlindSet blind_set = pipeline::synthesise(specimen, probing, how, seed, 1);
        blind_set.set.name = name;
        const pipeline::Strength& strength = blind_set.strength;
        std::string rows;
        for (int repeat = 0; repeat < (repeated ? options.repeats : 1); ++repeat) {
            const std::string own = repeated ? fmt::format("{}-{}", name, repeat) : name;
            const double noise = repeated ? 0.02 * strength.displacement : blind_set.noise;
            identify::write_measurement_set(
                options.out / own, repeated ? with_noise(blind_set.set, noise, seed + 7919 * repeat) : blind_set.set);
            mesh::write_text(options.out / "truth" / (own + ".json"),
                             pipeline::truth_of(blind_set, specimen, how, seed).dump(1));
            rows += fmt::format("{},{},{:.4g},{:.4g},{:.4g},{:.4g},\n", own, hidden, strength.displacement,
                                strength.change, strength.beyond, noise);
        }
        return {rows, fmt::format(
                          "{}: {} nodes, displacement {:.3g}, change {:.3g}, beyond stiffness {:.3g}, noise {:.3g} mm",
                          name, specimen.volume.nodes.rows(), strength.displacement, strength.change, strength.beyond,
                          blind_set.noise)};
    } catch (const std::exception& e) {
        return {"", fmt::format("{}: left out: {}", name, e.what())};
    }
}

void run(const Options& options) {
    fs::create_directories(options.out / "truth");
    std::vector<std::string> rows(static_cast<std::size_t>(options.sets));
    std::mutex telling;
    identify::for_each_in_parallel(options.sets, options.jobs, [&](int i) {
        const Drawn drawn = draw(options, i);
        const std::scoped_lock lock(telling);
        rows[static_cast<std::size_t>(i)] = drawn.rows;
        std::cout << drawn.line << std::endl;
    });
    std::string text = "set,effect,signal_rms_mm,effect_rms_mm,beyond_stiffness_rms_mm,sigma_mm,detail\n";
    for (const std::string& row : rows) text += row;
    mesh::write_text(options.out / "truth.csv", text);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    std::vector<std::string> hide;
    CLI::App app("Measurement sets with something hidden in them, on random bodies");
    app.add_option("OUT", options.out, "Folder to write to")->required();
    app.add_option("EFFECT", hide, "What to hide, EFFECT[+EFFECT], in turn; by default each effect of a solid");
    app.add_option("--sets", options.sets, "How many")->check(CLI::PositiveNumber);
    app.add_option("--seed", options.seed, "Of everything random");
    app.add_option("--jobs", options.jobs, "Bodies at once")->check(CLI::PositiveNumber);
    app.add_option("--repeats", options.repeats, "Readings of each body that hides nothing")
        ->check(CLI::PositiveNumber);
    app.add_flag("--thin", options.thin, "Plates and shells in place of solids");
    app.add_flag("--tool", options.tool, "Press with a ball that is moved, in place of forces");
    app.add_option("--coarser", options.coarser, "Elements so much longer")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    if (!hide.empty()) options.hide = hide;
    try {
        run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
