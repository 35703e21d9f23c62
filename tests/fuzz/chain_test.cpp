// From the file to triangles of equal size, all steps behind one another: whatever the shape, the chain ends in a body
// or in a message. Bodies and label images, broken in what they mean instead of in their bytes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <random>

#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/meshing/remesh.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/system/isolated.h"
#include "mesh/text/atomic_file.h"
#include "mesh/topology/check_surface.h"
#include "tests/fuzz/mutations.h"
#include "tests/temporary_folder.h"

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;
using mesh::Surface;

class Dice {
public:
    explicit Dice(std::uint64_t seed) : random_(seed) {}
    int below(int n) { return std::uniform_int_distribution(0, n - 1)(random_); }
    double within(double least, double most) { return std::uniform_real_distribution(least, most)(random_); }
    double gauss() { return std::normal_distribution<>()(random_); }
    Vec3 vector() { return {gauss(), gauss(), gauss()}; }
    /// Of any size that a number in a file has.
    double wild() { return (below(2) ? 1 : -1) * std::pow(10, within(-30, 30)); }

private:
    std::mt19937_64 random_;
};

Surface appended(const Surface& a, const Surface& b) {
    Surface both{Points(a.vertices.rows() + b.vertices.rows(), 3),
                 Triangles(a.triangles.rows() + b.triangles.rows(), 3)};
    both.vertices << a.vertices, b.vertices;
    both.triangles << a.triangles, b.triangles.array() + static_cast<int>(a.vertices.rows());
    return both;
}

Surface sound_body(Dice& dice) {
    switch (dice.below(4)) {
        case 0:
            return mesh::make_box({0, 0, 0}, Vec3(dice.within(1, 100), dice.within(1, 30), dice.within(0.1, 30)),
                                  {3, 2, 2});
        case 1:
            return mesh::make_sphere({0, 0, 0}, 10, 1 + dice.below(2));
        case 2:  // a shell, or two balls that cross
            return appended(mesh::make_sphere({0, 0, 0}, 10, 1), mesh::make_sphere(4 * dice.vector(), 6, 1));
        default:  // boxes that touch in a face, an edge or a corner
            return appended(
                mesh::make_box({0, 0, 0}, {10, 10, 10}, {2, 2, 2}),
                mesh::make_box(Vec3(10, 10 * dice.below(2), 10 * dice.below(2)), Vec3(20, 20, 20), {2, 2, 2}));
    }
}

void break_vertices(Surface& s, Dice& dice) {
    const auto row = [&] { return s.vertices.row(dice.below(static_cast<int>(s.vertices.rows()))); };
    switch (dice.below(7)) {
        case 0:
            row() += std::pow(10, dice.within(-3, 2)) * dice.vector().transpose();
            break;
        case 1:
            row() = dice.wild() * dice.vector().transpose();
            break;
        case 2:
            row()[dice.below(3)] = dice.wild();
            break;
        case 3:
            row() = row().eval();
            break;
        case 4:
            for (Eigen::Index v = 0; v < s.vertices.rows(); ++v) s.vertices.row(v) += 0.3 * dice.vector().transpose();
            break;
        case 5:
            s.vertices.col(dice.below(3)) *= std::pow(10, dice.within(-12, 3));
            break;
        default: {  // turned, stretched, sheared, moved, scaled
            Mat3 frame;
            for (int c = 0; c < 3; ++c) frame.col(c) = dice.vector();
            if (dice.below(2)) frame.col(2) = frame.col(1) + std::pow(10, dice.within(-9, 0)) * frame.col(2);
            const Vec3 shift = (dice.below(2) ? dice.wild() : 10.0) * dice.vector();
            const double scale = dice.below(3) == 0 ? dice.wild() : 1;
            s.vertices = ((scale * s.vertices * frame.transpose()).rowwise() + shift.transpose()).eval();
        }
    }
}

void break_triangles(Surface& s, Dice& dice) {
    const auto row = [&] { return dice.below(static_cast<int>(s.triangles.rows())); };
    const auto vertex = [&] { return dice.below(static_cast<int>(s.vertices.rows())); };
    switch (dice.below(6)) {
        case 0:  // holes
            for (int i = 0; i < 1 + dice.below(6) && s.triangles.rows() > 1; ++i) {
                s.triangles.row(row()) = s.triangles.bottomRows<1>().eval();
                s.triangles.conservativeResize(s.triangles.rows() - 1, 3);
            }
            break;
        case 1:  // fins and membranes
            for (int i = 0; i < 1 + dice.below(4); ++i) {
                s.triangles.conservativeResize(s.triangles.rows() + 1, 3);
                s.triangles.bottomRows<1>() << vertex(), vertex(), vertex();
            }
            break;
        case 2:
            for (int i = 0; i < 1 + dice.below(10); ++i) s.triangles.row(row()).reverseInPlace();
            break;
        case 3:
            s.triangles(row(), dice.below(3)) = vertex();
            break;
        case 4:  // twice
            s = appended(s, {s.vertices, s.triangles.topRows(1 + row())});
            break;
        default:  // a soup: no triangle shares a vertex
            Surface soup{Points(3 * s.triangles.rows(), 3), Triangles(s.triangles.rows(), 3)};
            for (Eigen::Index t = 0; t < s.triangles.rows(); ++t)
                for (int c = 0; c < 3; ++c) {
                    soup.triangles(t, c) = static_cast<int>(3 * t + c);
                    soup.vertices.row(3 * t + c) = s.vertices.row(s.triangles(t, c));
                }
            s = std::move(soup);
    }
}

fs::path broken_surface(const fs::path& folder, Dice& dice) {
    Surface s = sound_body(dice);
    for (int i = 0; i < dice.below(4); ++i) dice.below(2) ? break_vertices(s, dice) : break_triangles(s, dice);
    std::string text;
    for (const auto& v : s.vertices.rowwise()) text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", v[0], v[1], v[2]);
    for (const auto& t : s.triangles.rowwise()) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    mesh::write_text(folder / "body.obj", text);
    return folder / "body.obj";
}

/// A small image of a ball, a cross, lines, or voxels thrown by chance, in a frame of any kind. [nifti1.h]
fs::path broken_labels(const fs::path& folder, Dice& dice) {
    const std::array<int, 3> size{2 + dice.below(9), 2 + dice.below(9), 2 + dice.below(9)};
    const int kind = dice.below(4);
    const double share = dice.within(0.02, 0.98);
    std::string bytes(352, '\0');
    const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
    put(0, std::int32_t{348});
    put(40, std::int16_t{3});
    for (std::size_t d = 0; d < 3; ++d) put(42 + 2 * d, static_cast<std::int16_t>(size[d]));
    put(70, std::int16_t{2});
    put(72, std::int16_t{8});
    put(108, 352.0F);
    put(123, std::uint8_t{2});
    put(254, std::int16_t{1});
    const double scale = dice.below(3) == 0 ? dice.wild() : 1;
    const double shear = dice.below(2) ? std::pow(10, dice.within(-9, 0)) : 1;
    const Vec3 first = dice.vector();
    for (std::size_t r = 0; r < 3; ++r) {
        const double along = first[static_cast<int>(r)];
        for (std::size_t c = 0; c < 3; ++c) {
            const double own = r == c ? 1 : 0.2 * dice.gauss();
            const double value = dice.below(2) ? own : along + shear * own;
            put(280 + 16 * r + 4 * c, static_cast<float>(scale * value));
        }
        put(292 + 16 * r, static_cast<float>(dice.below(4) == 0 ? dice.wild() : 10 * dice.gauss()));
    }
    bytes.replace(344, 3, "n+1");
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) {
                const bool in_ball = Vec3(x - size[0] / 2.0, y - size[1] / 2.0, z - size[2] / 2.0).norm() < 5 * share;
                const bool in_line = y == size[1] / 2 && (z == size[2] / 2 || x == size[0] / 2);
                const bool by_chance = dice.within(0, 1) < share;
                bytes += kind == 0 ? in_ball : kind == 1 ? in_line : kind == 2 ? by_chance : (x + y + z) % 2 == 0;
            }
    mesh::write_text(folder / "labels.nii", bytes);
    return folder / "labels.nii";
}

/// What the commands do with a file; the surface in the end. Wrapping takes a hundred times as long as all the rest.
Surface meshed(const fs::path& file, bool may_wrap) {
    const mesh::BodyFile body = mesh::read_body(file);
    mesh::check_surface(body.surface);
    const mesh::RepairResult repaired = mesh::repair_surface(body.surface, {.may_wrap = may_wrap});
    return mesh::remesh(repaired.surface,
                        {.edge_length = 0.15 * mesh::bounding_box(repaired.surface.vertices).longest_side()});
}

enum class Ending { Meshed, Refused, Failed, Late, Broken };

/// How a chain of steps ends that is sound, or says why not.
Ending ending_of(const std::function<Surface()>& steps) {
    try {
        const Surface surface = steps();
        EXPECT_TRUE(mesh::check_surface(surface).sound());
        return Ending::Meshed;
    } catch (const InvalidInput&) {
        return Ending::Refused;
    } catch (const LimitReached&) {
        return Ending::Late;
    } catch (const SolverFailure& failure) {
        return std::string(failure.what()).find("broke off") == std::string::npos ? Ending::Failed : Ending::Broken;
    }
}

/// All of it in one process, for the sake of time; where that does not end well, each step in its own, as the commands
/// do: a message then, whatever the step did.
Ending ending_of(const fs::path& file, bool may_wrap) {
    const auto steps = [&] { return meshed(file, may_wrap); };
    const Ending together = ending_of([&] {
        return mesh::isolated_as<Surface>("The chain", "", {.seconds = may_wrap ? 60.0 : 10.0, .mebibytes = 4096},
                                          steps);
    });
    return together == Ending::Late || together == Ending::Broken ? ending_of(steps) : together;
}

void expect_endings(fs::path (*make)(const fs::path&, Dice&)) {
    const TemporaryFolder folder;
    std::map<Ending, int> count;
    const char* seed = std::getenv("PALPATE_FUZZ_SEED");
    const std::uint64_t first = seed ? std::strtoull(seed, nullptr, 10) : 1;
    for (int i = 0; i < inputs(200); ++i) {
        Dice dice(first + static_cast<std::uint64_t>(i));
        const fs::path file = make(folder.path(), dice);
        const Ending ending = ending_of(file, i % 32 == 0);
        ++count[ending];
        if (testing::Test::HasFailure()) FAIL() << "with the seed " << first + static_cast<std::uint64_t>(i);
    }
    for (const auto& [ending, times] : count) {
        const char* name =
            std::array{"meshed", "refused", "failed", "late", "broken"}[static_cast<std::size_t>(ending)];
        testing::Test::RecordProperty(name, times);
        std::cout << name << ": " << times << '\n';
    }
    EXPECT_GT(count[Ending::Meshed], inputs(200) / 20);
    EXPECT_GT(count[Ending::Refused], inputs(200) / 20);
    // What a step's limit ends, or its crash, is told; it is to stay rare.
    EXPECT_LE(count[Ending::Late] + count[Ending::Broken], 1 + inputs(200) / 50);
}

TEST(Chain, EndsInABodyOrAMessageWhateverTheSurface) { expect_endings(broken_surface); }
TEST(Chain, EndsInABodyOrAMessageWhateverTheLabels) { expect_endings(broken_labels); }

}  // namespace
}  // namespace palpate::fuzz
