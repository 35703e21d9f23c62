// Measurement sets with something hidden in them, on bodies and probe plans drawn at random, for diagnosis_bench.
// Usage: blind_set_bench OUT [--sets N] [--seed N] [--jobs N] [--repeats N] [--coarser FACTOR] [--thin] [--tool]
//                        [EFFECT[+EFFECT] ...]
// Without names: each effect of a solid in turn, nothing among them. OUT/truth.csv tells them all,
// OUT/truth/<set>.json their numbers.
// --repeats N reads each body in which nothing is hidden N times, with other noise; --coarser makes elements so much
// longer, for many sets in little time; --tool presses a ball in, a fifth as wide as the body is thick, at eight places
// to 2 and 4 % of the longest side, in place of forces, and reads its force beside the markers.
//
// Bodies are boxes made round, tapered, bent and twisted, 50 to 150 mm long and up to eight times as long as thick,
// held at one end, of .03 to 1 MPa and a Poisson's ratio of .4 to .48. --thin: plates and curved shells in their place,
// of 4 to 10 % of their length in thickness, held along one edge, at two corners of it, or along both.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include <iostream>
#include <mutex>
#include <random>
#include <sstream>

#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/read_case.h"
#include "pipeline/case/subject.h"
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

/// A box of 2 x 2 x 2 about the origin, made round by r in [0, 1]: 0 a box, 1 a ball. [Nowell's map of cube to sphere]
Vec3 rounded(const Vec3& p, double r) {
    const Vec3 s = p.cwiseAbs2();
    const Vec3 ball(p.x() * std::sqrt(1 - s.y() / 2 - s.z() / 2 + s.y() * s.z() / 3),
                    p.y() * std::sqrt(1 - s.z() / 2 - s.x() / 2 + s.z() * s.x() / 3),
                    p.z() * std::sqrt(1 - s.x() / 2 - s.y() / 2 + s.x() * s.y() / 3));
    return (1 - r) * p + r * ball;
}

/// A box of 2 x 2 x 2 and what is made of it.
struct Shape {
    mesh::Surface box;
    double length = 0, width = 0, height = 0;          // [mm]; it is bent in the plane of length and width
    double round = 0, taper = 0, bend = 0, twist = 0;  // bend, twist [rad]
};

Shape random_solid(std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double length = between(50, 150), aspect = std::exp(between(std::log(1.2), std::log(8)));
    const double width = length / aspect, height = width * between(0.6, 1);
    const double round = between(0, 1), taper = between(-0.3, 0.3), bend = between(0, 1.2), twist = between(-0.8, 0.8);
    return {mesh::make_box({-1, -1, -1}, {1, 1, 1}, {24, 12, 12}), length, width, height, round, taper, bend, twist};
}

Shape random_plate(std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double length = between(50, 150), thickness = length * std::exp(between(std::log(0.04), std::log(0.1)));
    const double breadth = length / between(1, 2.5), taper = between(-0.3, 0.3), bend = between(0, 1.2);
    return {mesh::make_box({-1, -1, -1}, {1, 1, 1}, {24, 2, 16}), length, thickness, breadth, 0, taper, bend, 0};
}

mesh::Surface body_of(const Shape& shape) {
    const auto& [box, length, width, height, round, taper, bend, twist] = shape;
    mesh::Surface body = box;
    for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) {
        Vec3 p = rounded(body.vertices.row(v), round);
        const double along = (p.x() + 1) / 2;  // from 0 at the held end
        const double scale = 1 - taper * (2 * along - 1);
        const Eigen::Rotation2Dd turn(twist * along);
        const Eigen::Vector2d section = turn * Eigen::Vector2d(p.y() * width / 2 * scale, p.z() * height / 2 * scale);
        // along an arc of that angle
        const double angle = bend * along, radius = bend > 1e-3 ? length / bend : 0;
        const Vec3 axis = bend > 1e-3 ? Vec3(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0)
                                      : Vec3(length * along, 0, 0);
        const Vec3 out(-std::sin(angle), std::cos(angle), 0);
        p = axis + section.x() * out + section.y() * Vec3::UnitZ();
        body.vertices.row(v) = p;
    }
    return body;
}

std::string support(const Vec3& low, const Vec3& high) {
    return fmt::format("  - box: {{min: [{:.4g}, {:.4g}, {:.4g}], max: [{:.4g}, {:.4g}, {:.4g}]}}\n", low.x(), low.y(),
                       low.z(), high.x(), high.y(), high.z());
}

/// Where a plate is held: along one edge, at two corners of it, or along both.
std::string supports_of_plate(const Vec3& low, const Vec3& high, double held, std::mt19937_64& random) {
    const int kind = std::uniform_int_distribution<int>(0, 2)(random);
    const double far = held + low.x(), breadth = high.z() - low.z();
    if (kind == 0) return support(low, {far, high.y(), high.z()});
    if (kind == 1)
        return support(low, {far, high.y(), low.z() + 0.2 * breadth}) +
               support({low.x(), low.y(), high.z() - 0.2 * breadth}, {far, high.y(), high.z()});
    return support(low, {far, high.y(), high.z()}) + support({high.x() - held, low.y(), low.z()}, high);
}

/// A case of that body, written to a folder of its own.
fs::path write_case(const fs::path& folder, bool thin, std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    fs::create_directories(folder);
    const mesh::Surface body = body_of(thin ? random_plate(random) : random_solid(random));
    mesh::write_surface(folder / "body.stl", body);
    const Vec3 low = body.vertices.colwise().minCoeff().transpose() - Vec3::Ones();
    const Vec3 high = body.vertices.colwise().maxCoeff().transpose() + Vec3::Ones();
    const double held = between(0.05, 0.12) * (high.x() - low.x() - 2) + 1;
    const double poisson = between(0.4, 0.48), young = std::exp(between(std::log(0.03), 0));
    const std::string supports =
        thin ? supports_of_plate(low, high, held, random) : support(low, {low.x() + held, high.y(), high.z()});
    mesh::write_text(folder / "case.yaml",
                     fmt::format("format: palpate-case/1\nmesh: body.stl\nunit: mm\n"
                                 "material: {{young: {:.4g}, poisson: {:.3g}, density: 1050}}\nsupports:\n{}",
                                 young, poisson, supports));
    return folder / "case.yaml";
}

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
    const std::uint64_t seed = options.seed * 100003 + static_cast<std::uint64_t>(i);
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
