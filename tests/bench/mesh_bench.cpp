// Meshes as people have them, and each broken in ten ways: does `palpate mesh` make a body, is it the right one, how
// long does it take, or what does it say? Run by hand:
//   mesh_bench build/palpate $PALPATE_DATA/meshes > table.md
// An accepted body is wrong when its volume is off by more than 5 %, or its boundary lies further than 5 % of the
// diagonal from the surface before it was broken (both ways). Where breaking moves thin walls, as noise does, the
// volume is held against what the broken surface still encloses.

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/text/atomic_file.h"
#include "meshes/breaks.h"

namespace {

namespace fs = std::filesystem;
using palpate::Points;
using palpate::Vec3;
using palpate::bench::Break;
using palpate::mesh::Surface;

constexpr double wrong_volume = 0.05;    // share
constexpr double wrong_distance = 0.05;  // of the diagonal
constexpr int time_limit = 600;          // [s]

struct Run {
    int code = 0;
    double seconds = 0;
    std::string message;
    bool is_hung() const { return code == 124 || code == 137; }
    bool is_crashed() const { return code != 0 && code != 3 && code != 4 && !is_hung(); }
};

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

Run run(const fs::path& program, const std::string& verb, const fs::path& input, const fs::path& output,
        const fs::path& scratch) {
    const fs::path said = scratch / "said.txt";
    const auto start = std::chrono::steady_clock::now();
    const std::string command =
        fmt::format("timeout -k 5 {} {} {} {} -o {} -q --force --threads 1 >/dev/null 2>{}", time_limit,
                    quoted(program), verb, quoted(input), quoted(output), quoted(said));
    const int status = std::system(command.c_str());
    Run result;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    std::ifstream in(said);
    std::getline(in, result.message);
    return result;
}

/// What a broken surface should come back as.
struct Expected {
    Surface surface;
    double volume = 0, diagonal = 0;
};

/// The union with the ball, its volume by counting points of the ball that lie outside of the body.
Expected with_ball(Expected body) {
    const Surface ball = palpate::bench::overlapping_ball(body.surface);
    const palpate::mesh::SurfaceTree inside_body(body.surface), inside_ball(ball);
    const auto box = palpate::mesh::bounding_box(ball.vertices);
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    int outside = 0;
    constexpr int points = 20000;
    for (int i = 0; i < points; ++i) {
        const Vec3 share(uniform(engine), uniform(engine), uniform(engine));
        const Vec3 at = box.min + share.cwiseProduct(box.extent());
        outside += inside_ball.inside(at) && !inside_body.inside(at);
    }
    body.volume += box.extent().prod() * outside / points;
    return body;
}

/// Largest distance of the corners and centres of one surface's triangles from another surface.
double furthest(const Surface& from, const Surface& to) {
    const palpate::mesh::SurfaceTree tree(to);
    double largest = 0;
    for (const auto& t : from.triangles.rowwise()) {
        const Points corners = from.vertices(t.transpose().eval(), Eigen::all);
        for (const auto& corner : corners.rowwise())
            largest = std::max(largest, tree.closest(corner.transpose()).distance);
        largest = std::max(largest, tree.closest(corners.colwise().mean().transpose()).distance);
    }
    return largest;
}

struct Verdict {
    double volume_error = 0, distance = 0;  // shares
    bool is_wrong() const { return std::abs(volume_error) > wrong_volume || distance > wrong_distance; }
};

Verdict judge(const fs::path& file, const Expected& expected, const Break& how) {
    const auto body = palpate::mesh::read_vtu(file);
    Surface surface = palpate::mesh::boundary_surface(body);
    const double volume = palpate::mesh::element_volumes(body).sum();
    if (how.offset > 0)
        surface.vertices.rowwise() -= Eigen::RowVector3d(1, -0.7, 0.4).normalized() * how.offset * expected.diagonal;
    Verdict verdict;
    verdict.volume_error = volume / expected.volume - 1;
    // Over a ball only the way back can be told: the body within it is gone.
    verdict.distance =
        how.has_ball ? 0 : std::max(furthest(surface, expected.surface), furthest(expected.surface, surface));
    verdict.distance /= expected.diagonal;
    return verdict;
}

struct Tally {
    int runs = 0, right = 0, refused = 0, wrong = 0, crashed = 0, hung = 0;
    int recognisable = 0, recognised = 0;
};

void report(const std::string& name, const Break& how, const Run& run, const std::optional<Verdict>& verdict,
            Tally& tally) {
    ++tally.runs;
    tally.recognisable += how.is_recognisable;
    std::string word, numbers = " | ";
    if (run.is_hung()) {
        ++tally.hung;
        word = "HUNG";
    } else if (run.is_crashed()) {
        ++tally.crashed;
        word = fmt::format("CRASHED ({})", run.code);
    } else if (run.code != 0) {
        ++tally.refused;
        word = "refused";
    } else if (verdict->is_wrong()) {
        ++tally.wrong;
        word = "WRONG";
    } else {
        ++tally.right;
        tally.recognised += how.is_recognisable;
        word = "mesh";
    }
    if (verdict) numbers = fmt::format("{:+.2f} | {:.2f}", 100 * verdict->volume_error, 100 * verdict->distance);
    std::string message = run.message.substr(0, 220);
    std::ranges::replace(message, '|', '/');
    fmt::print("| {} | {} | {} | {:.1f} | {} | {} |\n", name, how.name, word, run.seconds, numbers, message);
    std::fflush(stdout);
}

/// The original, mended where it needs it: what broken ones are judged by.
std::optional<Expected> expected_of(const Surface& surface) {
    try {
        Expected expected{palpate::mesh::repair_surface(surface).surface};
        expected.volume = palpate::mesh::signed_volume(expected.surface);
        expected.diagonal = palpate::mesh::bounding_box(expected.surface.vertices).diagonal();
        return expected;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

struct Options {
    fs::path program, folder, keep;
    std::string verb = "mesh";
    std::vector<std::string> only, breaks;

    bool asks_for(const std::string& name) const { return breaks.empty() || std::ranges::count(breaks, name) > 0; }
};

void bench(const Options& options, const fs::path& file, const fs::path& scratch, Tally& tally) {
    const std::string& verb = options.verb;
    const Surface surface = palpate::mesh::read_surface(file);
    const std::string name = file.filename().string();
    auto expected = expected_of(surface);
    const fs::path output = scratch / (verb == "mesh" ? "body.vtu" : "model.json");
    const auto attempt = [&](const fs::path& input, Break how) {
        if (!expected) how.is_recognisable = false;
        std::error_code none;
        fs::remove(output, none);
        const Run ran = run(options.program, verb, input, output, scratch);
        std::optional<Verdict> verdict;
        if (ran.code == 0 && verb == "mesh")
            verdict = judge(
                output, expected ? (how.has_ball ? with_ball(*expected) : *expected) : Expected{surface, 1, 1}, how);
        if (ran.code == 0 && verb != "mesh") verdict = Verdict{};
        report(name, how, ran, verdict, tally);
    };
    const double whole_volume = expected ? expected->volume : 0;
    for (const Break& how : palpate::bench::breaks()) {
        if (!options.asks_for(how.name)) continue;
        const fs::path input =
            (options.keep.empty() ? scratch : options.keep) / fmt::format("{}, {}.obj", file.stem().string(), how.name);
        // Corners are joined first, or a break of vertices would tear an STL to pieces.
        const Surface broken = how.apply(expected ? expected->surface : surface);
        palpate::mesh::write_surface(input, broken);
        if (expected) expected->volume = how.moves_walls ? palpate::mesh::signed_volume(broken) : whole_volume;
        attempt(std::string(how.name) == "as it is" ? file : input, how);
    }
    if (!options.asks_for("truncation")) return;
    const std::string whole = palpate::mesh::read_text(file);
    const fs::path cut = scratch / ("cut" + file.extension().string());
    palpate::mesh::write_text(cut, whole.substr(0, whole.size() * 6 / 10));
    attempt(cut, {"truncation", {}, false});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Meshes, whole and broken, through palpate");
    Options options;
    app.add_option("PROGRAM", options.program)->required()->check(CLI::ExistingFile);
    app.add_option("FOLDER", options.folder, "Of meshes")->required()->check(CLI::ExistingDirectory);
    app.add_option("--verb", options.verb, "mesh or skeleton")->check(CLI::IsMember({"mesh", "skeleton"}));
    app.add_option("--only", options.only, "Names of meshes");
    app.add_option("--break", options.breaks, "Ways to break them");
    app.add_option("--keep", options.keep, "Folder where broken meshes are left");
    CLI11_PARSE(app, argc, argv);

    const fs::path scratch = fs::temp_directory_path() / fmt::format("mesh_bench-{}", ::getpid());
    fs::create_directories(scratch);
    if (!options.keep.empty()) fs::create_directories(options.keep);
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(options.folder))
        if (entry.path().extension() != ".sph" &&
            (options.only.empty() || std::ranges::count(options.only, entry.path().filename().string()) > 0))
            files.push_back(entry.path());
    std::ranges::sort(files);

    fmt::print(
        "| mesh | broken by | result | s | volume off % | distance % of diagonal | message |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n");
    Tally tally;
    for (const fs::path& file : files) bench(options, file, scratch, tally);
    fmt::print(
        "\n{} runs: {} right, {} refused with a message, {} wrong, {} crashed, {} hung. Of {} whose body is still "
        "recognisable {} give one ({:.0f} %).\n",
        tally.runs, tally.right, tally.refused, tally.wrong, tally.crashed, tally.hung, tally.recognisable,
        tally.recognised, 100.0 * tally.recognised / std::max(1, tally.recognisable));
    fs::remove_all(scratch);
}
