#include "skeleton/construction/build.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::skeleton {
namespace {

// A bar of cells, of which those are kept whose middles the shape holds.
mesh::VolumeMesh carve(const mesh::VolumeMesh& bar, const Eigen::Vector3i& cells, const Vec3& size,
                       const std::function<bool(const Vec3&)>& shape) {
    std::vector<int> kept;
    const Vec3 step = size.cwiseQuotient(cells.cast<double>());
    for (int t = 0; t < bar.tetrahedra.rows(); ++t) {
        Vec3 center = Vec3::Zero();
        for (int c = 0; c < 4; ++c) center += bar.nodes.row(bar.tetrahedra(t, c)).transpose() / 4;
        const Vec3 cell = (center.cwiseQuotient(step).array().floor() + 0.5).matrix().cwiseProduct(step);
        if (shape(cell)) kept.push_back(t);
    }
    mesh::VolumeMesh body;
    body.tetrahedra.resize(static_cast<Eigen::Index>(kept.size()), 4);
    std::vector<int> index(bar.nodes.rows(), -1);
    std::vector<Vec3> nodes;
    for (std::size_t t = 0; t < kept.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            int& node = index[bar.tetrahedra(kept[t], c)];
            if (node < 0) {
                node = static_cast<int>(nodes.size());
                nodes.push_back(bar.nodes.row(bar.tetrahedra(kept[t], c)));
            }
            body.tetrahedra(static_cast<Eigen::Index>(t), c) = node;
        }
    }
    body.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
    for (std::size_t i = 0; i < nodes.size(); ++i) body.nodes.row(static_cast<Eigen::Index>(i)) = nodes[i];
    body.faces = mesh::boundary_faces(body.tetrahedra);
    return body;
}

mesh::VolumeMesh block(const Vec3& size, const Eigen::Vector3i& cells) {
    return mesh::make_bar(Vec3::Zero(), size, cells);
}

// Holds the face x = 0.
std::vector<mesh::Region> clamp() { return {mesh::BoxRegion{Vec3(-0.1, -1e3, -1e3), Vec3(0.1, 1e3, 1e3)}}; }

struct Built {
    mesh::Surface surface;
    Model model;
    BuildReport report;
};

Built build(const mesh::VolumeMesh& body, const BuildOptions& options = {},
            const std::vector<mesh::Region>& supports = clamp(), const fem::Material& material = {}) {
    Built built;
    built.surface = mesh::boundary_surface(body);
    built.model = build_skeleton(built.surface, body, material, supports, options, &built.report);
    return built;
}

int free_spheres(const Model& model) {
    return static_cast<int>(std::count_if(model.spheres.begin(), model.spheres.end(), [](auto& s) { return !s.held; }));
}

int components(const Model& model) {
    std::vector<int> part(model.spheres.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](int i) {
        while (part[i] != i) i = part[i];
        return i;
    };
    for (const Link& link : model.links) part[root(link.a)] = root(link.b);
    int count = 0;
    for (int i = 0; i < static_cast<int>(part.size()); ++i) count += part[i] == i;
    return count;
}

int loops(const Model& model) {
    return static_cast<int>(model.links.size()) - static_cast<int>(model.spheres.size()) + components(model);
}

// Bodies of each kind: a limb, a plate, a lump.
const Vec3 limb_size(160, 16, 16), plate_size(100, 80, 6), lump_size(60, 40, 40);
mesh::VolumeMesh limb() { return block(limb_size, {40, 4, 4}); }
mesh::VolumeMesh plate() { return block(plate_size, {25, 20, 2}); }
mesh::VolumeMesh lump() { return block(lump_size, {12, 8, 8}); }

// Built once, with default options.
const Built& built_limb() {
    static const Built built = build(limb());
    return built;
}
const Built& built_plate() {
    static const Built built = build(plate());
    return built;
}
const Built& built_lump() {
    static const Built built = build(lump());
    return built;
}

// How far the middle of the far end gives way to a force of 1 mN there, linear.
double give(const Model& built, const Vec3& tip, const Vec3& direction) {
    Model model = built;
    model.law = EquilibriumLaw::linear;
    const Attachment end = attach(model, tip);
    Load load;
    load.forces.push_back({end, 1e-3 * direction});
    return direction.dot(observe(model, equilibrium(model, load), {end}).row(0).transpose() - tip);
}
double sag(const Model& built, const Vec3& tip) { return give(built, tip, -Vec3::UnitZ()); }

TEST(BuildSkeleton, IsOnePieceInsideTheBodyWithSoundLinks) {
    for (const Built& built : {built_limb(), built_plate(), built_lump()}) {
        const mesh::SurfaceTree tree(built.surface);
        EXPECT_EQ(components(built.model), 1);
        for (const Sphere& s : built.model.spheres) {
            EXPECT_GT(s.radius, 0);
            EXPECT_GT(s.mass, 0);
            // Held spheres stand on the held face itself.
            if (s.held) {
                EXPECT_LT(tree.closest(s.center).distance, 1e-6);
            } else {
                EXPECT_TRUE(tree.inside(s.center));
            }
        }
        for (const Link& link : built.model.links) {
            EXPECT_LT(link.a, link.b);
            EXPECT_FALSE(built.model.spheres[link.a].held && built.model.spheres[link.b].held);
            EXPECT_GT(link.stiffness.minCoeff(), 0);
            EXPECT_NEAR(link.length, (built.model.spheres[link.b].center - built.model.spheres[link.a].center).norm(),
                        1e-9);
            EXPECT_GT(link.length, 0.5);
        }
        EXPECT_EQ(built.model.skin.size(), static_cast<std::size_t>(built.surface.vertices.rows()));
    }
}

TEST(BuildSkeleton, ALimbIsAChainAPlateALayerALumpIsFilled) {
    // Fifteen or so along a limb; the extra ones cover the edges of its end.
    const Built chain = build(limb(), {.spheres = 15});
    EXPECT_EQ(loops(chain.model), 0);
    for (const Sphere& s : chain.model.spheres) {
        // On the axis, by symmetry; jagged cells leave 0.02 mm of 8.
        EXPECT_LT((s.center - Vec3(s.center.x(), 8, 8)).norm(), 0.03);
    }
    EXPECT_GE(free_spheres(built_limb().model), 10);
    EXPECT_LE(free_spheres(built_limb().model), 30);

    const Built& layer = built_plate();
    EXPECT_NEAR(free_spheres(layer.model), 60, 3);  // a tie that rounding decides takes or gives a few
    for (const Sphere& s : layer.model.spheres) EXPECT_NEAR(s.center.z(), 3, 0.15);  // jagged cells leave 0.12 mm

    const Built& filled = built_lump();
    EXPECT_GE(free_spheres(filled.model), 120);
    double inner = 0;
    for (const Sphere& s : filled.model.spheres) inner += ((s.center - lump_size / 2).cwiseAbs().array() < 12).all();
    EXPECT_GE(inner, 5);
}

TEST(BuildSkeleton, MassAndInertiaAddUpToTheBodys) {
    fem::Material material;
    material.density = 1.1e-9;
    const Model model = build(lump(), {}, clamp(), material).model;
    double mass = 0;
    Vec3 first = Vec3::Zero();
    Mat3 inertia = Mat3::Zero();
    for (const Sphere& s : model.spheres) {
        mass += s.mass;
        first += s.mass * s.center;
        const Vec3 d = s.center - lump_size / 2;
        inertia += s.inertia + s.mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
        EXPECT_GT(s.inertia.eigenvalues().real().minCoeff(), 0);
    }
    const double expected = material.density * lump_size.prod();
    EXPECT_NEAR(mass, expected, 1e-12 * expected);
    // Spheres do not stand exactly in the middle of their cells, those on the support least: 0.12 mm in the mean, 2 %
    // of the moments of inertia.
    EXPECT_LT((first / mass - lump_size / 2).norm(), 0.15);
    const Vec3 squares = lump_size.cwiseAbs2();
    const Vec3 moments = expected / 12 * (squares.sum() * Vec3::Ones() - squares);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(inertia(k, k), moments(k), 0.02 * moments(k));
}

TEST(BuildSkeleton, LinksOfABarStandForItsSection) {
    const fem::Material material;
    const Model model = build(limb(), {.spheres = 12, .links = LinkKind::burion2008}).model;
    ASSERT_EQ(model.links.size(), 12u);
    for (const Link& link : model.links) {
        // Exact but for spheres that are 0.02 mm from the axis: a share of 1e-4, to first order.
        EXPECT_NEAR(link.stiffness(0) * link.length / material.young, 256, 1e-4 * 256);
        EXPECT_NEAR(link.stiffness(1) * link.length / (2 * material.young), 16. * 16 * 16 * 16 / 12, 1e-4 * 5461);
        EXPECT_NEAR(link.gyration, 16 / std::sqrt(12), 1e-4 * 16);
    }
}

TEST(BuildSkeleton, AnUncalibratedChainBendsLikeABeam) {
    const fem::Material material;
    const double length = 160, I = std::pow(16., 4) / 12;
    const double euler = 1e-3 * std::pow(length, 3) / (3 * material.young * I);
    // Chains of more than ten links are within 1 / 10^2 of the continuous beam.
    EXPECT_NEAR(sag(build(limb(), {.spheres = 14}).model, Vec3(160, 8, 8)) / euler, 1, 0.01);
    EXPECT_NEAR(sag(built_limb().model, Vec3(160, 8, 8)) / euler, 1, 0.01);
}

/// A thick limb's square end gets spheres of its own for its corners. Pushed at a corner, the end face stays a face:
/// its vertices lie within a fiftieth of the deflection round where the face's mean motion and turn put them.
TEST(BuildSkeleton, AnEndPushedAtItsCornerKeepsItsShape) {
    const Built built = build(block(Vec3(100, 30, 30), {20, 6, 6}), {.coverage = 3});
    ASSERT_GT(loops(built.model), 0) << "corners without spheres of their own test nothing";
    const fem::Material material;
    const double force = 2 * 3 * material.young * std::pow(30., 4) / 12 / std::pow(100., 3);  // [N], 2 mm by Euler
    Load load;
    load.forces.push_back({attach(built.model, Vec3(100, 30, 30)), Vec3(0, 0, -force)});
    const Equilibrium bent = equilibrium(built.model, load);

    std::vector<Attachment> end;
    for (const Attachment& vertex : built.model.skin) {
        if (vertex.rest.x() > 99.9) end.push_back(vertex);
    }
    Points rest(std::ssize(end), 3);
    for (std::size_t i = 0; i < end.size(); ++i) rest.row(static_cast<Eigen::Index>(i)) = end[i].rest;
    const Points moved = observe(built.model, bent, end);
    const Eigen::Matrix4d motion = Eigen::umeyama(rest.transpose().eval(), moved.transpose().eval(), false);
    const Points rigid =
        (rest * motion.topLeftCorner<3, 3>().transpose()).rowwise() + motion.topRightCorner<3, 1>().transpose();
    const double deflection = (moved - rest).rowwise().norm().mean();
    EXPECT_NEAR(deflection, 1.8, 0.1);  // what an uncalibrated skeleton makes of Euler's 2 mm
    EXPECT_LT((moved - rigid).rowwise().norm().maxCoeff(), 0.02 * deflection);
}

TEST(BuildSkeleton, AnUncalibratedLumpBendsLikeABeam) {
    const fem::Material material;
    const double area = 1600, I = area * area / 12;
    const double timoshenko =
        1e-3 * (std::pow(60., 3) / (3 * material.young * I) + 60 / (5. / 6 * material.shear_modulus() * area));
    const double ratio = sag(built_lump().model, Vec3(60, 20, 20)) / timoshenko;
    EXPECT_NEAR(ratio, 1, 0.05);  // a lump of 60 x 40 x 40 mm is hardly a beam: 0.96
}

TEST(BuildSkeleton, AnUncalibratedPlateBendsLikeAStrip) {
    const fem::Material material;
    const double euler = 1e-3 * std::pow(100., 3) / (3 * material.young * 80 * std::pow(6., 3) / 12);
    const double ratio = sag(built_plate().model, Vec3(100, 40, 3)) / euler;
    EXPECT_NEAR(ratio, 1.11, 0.03);  // the force acts at one point of the width
}

/// A bracket that is bolted to a wall by all of the back of its upright, x = 0: no depth of it is held, and every
/// sphere that stands there is tied to the wall.
TEST(BuildSkeleton, APlateThatIsHeldByItsFaceBearsWhatGrowsOutOfIt) {
    const Vec3 size(60, 30, 48);
    const Eigen::Vector3i cells(20, 10, 16);
    const mesh::VolumeMesh bracket =
        carve(block(size, cells), cells, size, [](const Vec3& p) { return p.x() < 6 || p.z() < 6; });
    const Model model = build(bracket).model;
    std::vector<char> tied(model.spheres.size(), 0);
    for (const Link& link : model.links) {
        if (model.spheres[link.a].held) tied[link.b] = 1;
        if (model.spheres[link.b].held) tied[link.a] = 1;
    }
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const Vec3& center = model.spheres[i].center;
        const bool stands_on_it = !model.spheres[i].held && center.x() < 5 && center.z() > 9;
        EXPECT_TRUE(tied[i] || !stands_on_it) << center.transpose();
    }
    const fem::Material material;
    const auto beam = [&](double width, double height) {
        const double I = width * std::pow(height, 3) / 12, area = width * height;
        return 1e-3 * (std::pow(54., 3) / (3 * material.young * I) + 54 / (5. / 6 * material.shear_modulus() * area));
    };
    const double down = sag(model, Vec3(60, 15, 3)) / beam(30, 6);
    EXPECT_NEAR(down, 1.42, 0.05);  // the arm's root gives, which the beam's clamp does not
    const double aside = give(model, Vec3(60, 15, 3), Vec3::UnitY()) / beam(6, 30);
    EXPECT_NEAR(aside, 1.50, 0.05);
}

TEST(BuildSkeleton, CoversTheSurfaceByDefault) {
    for (const Built& built : {built_limb(), built_plate(), built_lump()}) {
        const double bound = 0.05 * mesh::bounding_box(built.surface.vertices).longest_side();
        double worst = 0;
        for (Eigen::Index v = 0; v < built.surface.vertices.rows(); ++v) {
            const Vec3 vertex = built.surface.vertices.row(v);
            if (mesh::contains(clamp(), vertex)) continue;
            double least = 1e300;
            for (const Sphere& s : built.model.spheres) least = std::min(least, (vertex - s.center).norm() - s.radius);
            worst = std::max(worst, least);
        }
        EXPECT_LE(worst, bound);
        EXPECT_NEAR(built.report.coverage, worst, 1e-9);
        EXPECT_TRUE(built.report.notes.empty());
    }
}

TEST(BuildSkeleton, GivesAsManySpheresAsAskedAndSaysWhatTheyLeaveUncovered) {
    for (int n : {1, 40}) {
        EXPECT_EQ(free_spheres(build(limb(), {.spheres = n}).model), n);
        EXPECT_EQ(free_spheres(build(plate(), {.spheres = n}).model), n);
        EXPECT_EQ(free_spheres(build(lump(), {.spheres = n}).model), n);
    }
    // More than a chain can hold: in layers.
    EXPECT_EQ(free_spheres(build(limb(), {.spheres = 300}).model), 300);
    const Built few = build(lump(), {.spheres = 3});
    EXPECT_GT(few.report.coverage, 3);
    ASSERT_EQ(few.report.notes.size(), 1u);
    EXPECT_NE(few.report.notes[0].find("3 spheres leave"), std::string::npos);
}

TEST(BuildSkeleton, ASymmetricLumpGetsAnEvenFilling) {
    const Model model = built_lump().model;
    Vec3 mean = Vec3::Zero();
    for (const Sphere& s : model.spheres) {
        if (!s.held) mean += s.center / free_spheres(model);
    }
    // In the middle across; a little beyond it along, where no held spheres fill the place.
    EXPECT_NEAR(mean.y(), 20, 0.15);  // jagged cells leave 0.1 mm
    EXPECT_NEAR(mean.z(), 20, 0.15);
    EXPECT_NEAR(mean.x(), 33, 0.3);
}

TEST(BuildSkeleton, ATurnedAndMovedBodyGetsAsManySpheres) {
    for (const auto& body : {limb(), plate(), lump()}) {
        mesh::VolumeMesh turned = body;
        const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
        const Vec3 shift(300, -40, 11);
        turned.nodes = (turned.nodes * R.transpose()).rowwise() + shift.transpose();
        const std::vector<mesh::Region> support{mesh::PlaneRegion{shift, R.col(0), 0.1}};
        // Only the covering spheres may differ: the longest side of the box is another one.
        const int upright = free_spheres(build(body, {.coverage = 6}).model);
        EXPECT_NEAR(free_spheres(build(turned, {.coverage = 6}, support).model), upright, 1);
    }
}

TEST(BuildSkeleton, ARingIsALoop) {
    const Vec3 size(80, 80, 10);
    const Eigen::Vector3i cells(16, 16, 2);
    const auto ring = carve(block(size, cells), cells, size,
                            [](const Vec3& x) { return std::max(std::abs(x.x() - 40), std::abs(x.y() - 40)) > 30; });
    const Model model = build(ring, {.spheres = 24}).model;
    EXPECT_EQ(components(model), 1);
    EXPECT_GE(loops(model), 1);
}

TEST(BuildSkeleton, NothingIsLinkedAcrossAGap) {
    // Two limbs on a common foot, a gap of 2 mm between them.
    const Vec3 size(100, 22, 10);
    const Eigen::Vector3i cells(25, 11, 5);
    const auto fork =
        carve(block(size, cells), cells, size, [](const Vec3& x) { return x.x() < 12 || std::abs(x.y() - 11) > 1; });
    const Model model = build(fork, {.spheres = 24}).model;
    int in_limbs = 0;
    for (const Link& link : model.links) {
        const Vec3 &a = model.spheres[link.a].center, &b = model.spheres[link.b].center;
        if (a.x() < 20 || b.x() < 20) continue;
        ++in_limbs;
        EXPECT_GT((a.y() - 11) * (b.y() - 11), 0);
    }
    EXPECT_GE(in_limbs, 10);
}

TEST(BuildSkeleton, ZonesFollowTheBodyFromTheSupport) {
    const Model model = build(limb(), {.spheres = 12, .zones = 3}).model;
    std::vector<int> count(3, 0);
    for (const Link& p : model.links) {
        ++count.at(p.zone);
        for (const Link& q : model.links) {
            const double at_p = model.spheres[p.a].center.x() + model.spheres[p.b].center.x();
            const double at_q = model.spheres[q.a].center.x() + model.spheres[q.b].center.x();
            EXPECT_TRUE(p.zone >= q.zone || at_p < at_q);
        }
    }
    EXPECT_EQ(count, std::vector<int>({4, 4, 4}));
}

TEST(BuildSkeleton, TheSameBodyGivesTheSameSpheres) {
    const Model first = built_limb().model, second = build(limb()).model;
    ASSERT_EQ(first.spheres.size(), second.spheres.size());
    for (std::size_t i = 0; i < first.spheres.size(); ++i) EXPECT_EQ(first.spheres[i].center, second.spheres[i].center);
}

TEST(BuildSkeleton, AThickSupportHoldsWhatLiesInIt) {
    const std::vector<mesh::Region> support{mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(15, 50, 50)}};
    const Model model = build(lump(), {}, support).model;
    double held = 0, mass = 0;
    for (const Sphere& s : model.spheres) {
        mass += s.mass;
        held += s.held ? s.mass : 0;
        EXPECT_EQ(s.held, s.center.x() <= 15 + 1e-9);
    }
    EXPECT_GE(held, 0.25 * mass);  // 15 of 60 mm
}

std::string message(const mesh::VolumeMesh& body, const BuildOptions& options,
                    const std::vector<mesh::Region>& supports) {
    try {
        build(body, options, supports);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(BuildSkeleton, SaysWhatIsWrongWithTheInput) {
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    const std::vector<mesh::Region> beside{mesh::BoxRegion{Vec3(200, 0, 0), Vec3(210, 9, 9)}};
    const std::string nothing = message(limb(), {}, beside);
    EXPECT_TRUE(has(nothing, "hold nothing")) << nothing;
    EXPECT_TRUE(has(nothing, "(0, 0, 0) to (160, 16, 16) mm")) << nothing;
    EXPECT_TRUE(has(nothing, "(200, 0, 0) to (210, 9, 9) mm")) << nothing;
    EXPECT_TRUE(has(message(limb(), {}, {}), "none is given"));

    const std::vector<mesh::Region> all{mesh::SphereRegion{Vec3(80, 8, 8), 200}};
    EXPECT_TRUE(has(message(limb(), {}, all), "hold the whole body"));
    EXPECT_TRUE(has(message(limb(), {.spheres = -1}, clamp()), "spheres is -1"));
    EXPECT_TRUE(has(message(limb(), {.coverage = -2}, clamp()), "coverage is -2 mm"));
    EXPECT_TRUE(has(message(limb(), {.zones = 0}, clamp()), "zones is 0"));

    // Two blocks with nothing between them.
    const Vec3 size(60, 10, 10);
    const Eigen::Vector3i cells(6, 2, 2);
    const auto apart = carve(block(size, cells), cells, size, [](const Vec3& x) { return std::abs(x.x() - 30) > 12; });
    EXPECT_TRUE(has(message(apart, {}, clamp()), "in several pieces"));
}

}  // namespace
}  // namespace palpate::skeleton
