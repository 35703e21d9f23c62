#include "tests/bench/runtime/bullet.h"

#include <fmt/format.h>

#ifdef PALPATE_WITH_BULLET
#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <vector>

#include "tests/bench/runtime/models.h"
#endif

namespace palpate::bench {

#ifdef PALPATE_WITH_BULLET

namespace {

double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Median nanoseconds a link and step, one iteration of positions, no collisions, no wind.
double bullet_step(const skeleton::Model& model) {
    btSoftBodyWorldInfo info;
    info.m_gravity = btVector3(0, 0, 0);
    info.air_density = 0;
    info.water_density = 0;
    std::vector<btVector3> nodes;
    std::vector<btScalar> masses;
    for (const skeleton::Sphere& sphere : model.spheres) {
        const Eigen::Vector3f x = sphere.center.cast<float>();
        nodes.emplace_back(x.x(), x.y(), x.z());
        masses.push_back(sphere.held ? 0 : 1);
    }
    btSoftBody body(&info, static_cast<int>(nodes.size()), nodes.data(), masses.data());
    for (const skeleton::Link& link : model.links) body.appendLink(link.a, link.b);
    body.m_materials[0]->m_kLST = 0.5;
    body.m_cfg.piterations = 1;
    body.m_cfg.collisions = 0;
    body.m_nodes[body.m_nodes.size() - 1].m_v = btVector3(0, 10, 0);
    std::vector<double> runs;
    for (int run = 0; run < 9; ++run) {
        const double start = processor_seconds();
        for (int i = 0; i < 50; ++i) {
            body.predictMotion(1e-3F);
            body.solveConstraints();
            body.integrateMotion();
        }
        runs.push_back((processor_seconds() - start) / 50);
    }
    std::ranges::nth_element(runs, runs.begin() + 4);
    return 1e9 * runs[4] / static_cast<double>(model.links.size());
}

}  // namespace

void print_bullet() {
    fmt::print(
        "\nBullet's soft body on the same bodies: links have a length alone, single precision, one iteration\n\n"
        "| links | body | ns a link and step |\n| --- | --- | --- |\n");
    for (const auto& [name, model] :
         {std::pair{"chain", chain(1000, false)}, std::pair{"chain", chain(10000, false)},
          std::pair{"lattice", lattice({8, 8, 6}, false)}, std::pair{"lattice", lattice({15, 15, 16}, false)}}) {
        fmt::print("| {} | {} | {:.1f} |\n", model.links.size(), name, bullet_step(model));
    }
}

#else

void print_bullet() { fmt::print("\nBullet: this program was built without it (libbullet-dev).\n"); }

#endif

}  // namespace palpate::bench
