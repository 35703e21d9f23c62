// How well spheres and links follow bodies of all kinds: shapes made here, and the surfaces of a folder.
// Usage: placement_bench [FOLDER of surfaces] [NAME of one body, or -]. A table of skeletons by default options and,
// but for -, how many spheres there are when the body is noisy, turned, meshed coarser and finer, and how coverage
// falls with spheres. Percentages are of the longest side.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "skeleton/construction/build.h"
#include "tests/skeleton/measures.h"
#include "tests/skeleton/shapes.h"

using namespace palpate;
using namespace palpate::skeleton;

namespace {

struct Row {
    Measures measures;
    Model model;
    double size = 0;             // longest side [mm]
    double mesh = 0, build = 0;  // [s]
    int triangles = 0, handles = 0;
    mesh::Surface surface;
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string failure;  // of the last body that could not be placed

std::optional<Row> place(const mesh::Surface& surface, const mesh::PlaneRegion& support, double share = 0.06,
                         const BuildOptions& options = {}) {
    try {
        Row row;
        const double start = now();
        Meshed body = meshed(surface, share);
        const double middle = now();
        BuildOptions without_skin = options;
        without_skin.condense = false;
        row.model = build_skeleton(body.surface, body.volume, {}, {support}, without_skin);
        row.mesh = middle - start;
        row.build = now() - middle;
        row.measures = measure(row.model, mesh::SurfaceTree(body.surface));
        row.size = mesh::bounding_box(body.surface.vertices).longest_side();
        row.triangles = static_cast<int>(body.surface.triangles.rows());
        row.handles = handles(body.surface);
        row.surface = body.surface;
        return row;
    } catch (const std::exception& error) {
        failure = error.what();
        return {};
    }
}

void print_head() {
    fmt::print("{:<28}{:>7}{:>5}{:>5}{:>5}{:>6}{:>8}{:>7}{:>6}{:>6}{:>5}{:>5}{:>9}{:>9}{:>7}{:>7}  {}\n", "body",
               "triang", "hand", "free", "held", "links", "cov mm", "cov %", "comp", "loops", "tips", "dup",
               "link out%", "cent out%", "mesh s", "build s", "asymmetry y z");
}

void print_row(const std::string& name, const Row& row, const Mat3& mirrors) {
    const Measures& m = row.measures;
    fmt::print("{:<28}{:>7}{:>5}{:>5}{:>5}{:>6}{:>8.3f}{:>7.2f}{:>6}{:>6}{:>5}{:>5}{:>9.2f}{:>9.2f}{:>7.2f}{:>7.2f} ",
               name, row.triangles, row.handles, m.free, m.held, m.links, m.coverage, 100 * m.coverage / row.size,
               m.components, m.loops, m.tips, m.duplicates, 100 * m.worst_link / row.size,
               100 * m.worst_center / row.size, row.mesh, row.build);
    for (int k = 0; k < 3; ++k) {
        if (mirrors.col(k).norm() > 0) fmt::print(" {:.2f}", asymmetry(row.model, mirrors.col(k), Vec3::Zero()));
    }
    fmt::print("\n");
    std::fflush(stdout);
}

void print_variant(const char* name, const std::optional<Row>& row, const Row& base) {
    if (!row) {
        fmt::print("    {:<14} fails: {}\n", name, failure.substr(0, 100));
        return;
    }
    const Measures& m = row->measures;
    const double change = 100. * (m.free - base.measures.free) / base.measures.free;
    fmt::print(
        "    {:<14} free {:>4} ({:+.0f} %{}) held {} loops {} tips {} coverage {:.2f} % link out {:.2f} % "
        "build {:.2f} s ({} triangles)\n",
        name, m.free, change, std::abs(change) > 10 ? " !" : "", m.held, m.loops, m.tips, 100 * m.coverage / row->size,
        100 * m.worst_link / row->size, row->build, row->triangles);
    std::fflush(stdout);
}

void study(const Shape& body, bool variants) {
    const mesh::PlaneRegion support = end_clamp(body.surface);
    const std::optional<Row> base = place(body.surface, support);
    if (!base) {
        fmt::print("{:<28} fails: {}\n", body.name, failure);
        return;
    }
    print_row(body.name, *base, body.mirrors);
    if (!variants) return;
    for (unsigned seed : {1u, 2u}) {
        print_variant("noise 0.2 %", place(noisy(body.surface, 0.002, seed), support), *base);
        print_variant("noise 0.5 %", place(noisy(body.surface, 0.005, seed), support), *base);
        // Noise that remeshing does not smooth.
        print_variant("noise 0.2 fine", place(noisy(base->surface, 0.002, seed), support, 0.03), *base);
        print_variant("noise 0.5 fine", place(noisy(base->surface, 0.005, seed), support, 0.03), *base);
    }
    const Motion motion = some_motion();
    // As fine in the same millimetres: the longest side of a turned body is another one.
    const mesh::Surface turned = motion(body.surface);
    const double ratio = base->size / mesh::bounding_box(turned.vertices).longest_side();
    print_variant("turned", place(turned, motion(support), 0.06 * ratio, {.coverage = 0.05 * base->size}), *base);
    print_variant("coarser", place(body.surface, support, 0.12), *base);
    print_variant("finer", place(body.surface, support, 0.03), *base);
    const auto again = place(body.surface, support), mixed = place(shuffled(body.surface, 3), support);
    for (const auto& [name, other] : {std::pair("again", again), std::pair("shuffled", mixed)}) {
        if (!other || other->model.spheres.size() != base->model.spheres.size()) {
            fmt::print("    {:<14} another number of spheres\n", name);
            continue;
        }
        double worst = 0;
        for (std::size_t i = 0; i < base->model.spheres.size(); ++i) {
            double least = 1e300;
            for (const Sphere& s : other->model.spheres)
                least = std::min(least, (s.center - base->model.spheres[i].center).norm());
            worst = std::max(worst, least);
        }
        fmt::print("    {:<14} spheres apart by {:.2g} of the size\n", name, worst / base->size);
    }
    fmt::print("    coverage %, asymmetry by spheres:");
    for (int n : {8, 16, 32, 64, 128, 256}) {
        const auto row = place(body.surface, support, 0.06, {.spheres = n});
        if (!row) continue;
        fmt::print("  {} {:.2f}", n, 100 * row->measures.coverage / row->size);
        for (int k = 0; k < 3; ++k) {
            if (body.mirrors.col(k).norm() > 0)
                fmt::print("{}{:.2f}", k < 2 ? " (" : " ", asymmetry(row->model, body.mirrors.col(k), Vec3::Zero()));
        }
        if (body.mirrors.norm() > 0) fmt::print(")");
    }
    fmt::print("\n");
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string folder = argc > 1 ? argv[1] : "", only = argc > 2 ? argv[2] : "";
    std::vector<Shape> bodies = all_shapes();
    if (!folder.empty()) {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        for (const auto& file : files) {
            try {
                bodies.push_back({file.filename().string(), mesh::read_surface(file)});
            } catch (const std::exception& error) {
                fmt::print("{:<28} fails: {}\n", file.filename().string(), error.what());
            }
        }
    }
    const bool variants = only != "-";
    print_head();
    for (const Shape& body : bodies) {
        if (only.empty() || !variants || body.name == only) study(body, variants);
    }
}
