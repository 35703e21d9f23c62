// How fast the model plays, and how well it keeps energy and momenta. Prints tables; Bullet beside it, where the
// program was built with it. One core, medians of several runs. `runtime_bench [STEPS]`: of the last table, 1000000.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

#include "skeleton/model/attachment/attach.h"
#include "skeleton/runtime/body.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/bench/runtime/bullet.h"
#include "tests/bench/runtime/models.h"

namespace {

using namespace palpate;
using runtime::Body;

// Of this thread's processor time, so that what else the machine does counts little.
double seconds(const std::function<void()>& work) {
    const auto now = [] {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
    const double start = now();
    work();
    return now() - start;
}

// Median over runs of at least some 20 ms each, in seconds a call.
double median(const std::function<void()>& call) {
    int calls = 1;
    while (seconds([&] {
               for (int i = 0; i < calls; ++i) call();
           }) < 0.02 &&
           calls < 1'000'000)
        calls *= 2;
    std::vector<double> runs;
    for (int run = 0; run < 7; ++run) {
        runs.push_back(seconds([&] {
                           for (int i = 0; i < calls; ++i) call();
                       }) /
                       calls);
    }
    std::ranges::nth_element(runs, runs.begin() + 3);
    return runs[3];
}

void print_steps() {
    fmt::print(
        "\nExplicit step, one core\n\n| links | kind | body | ns a link and step | damped | with energy read |\n"
        "| --- | --- | --- | --- | --- | --- |\n");
    for (const bool full : {false, true}) {
        for (const auto& [name, model] :
             {std::pair{"chain", bench::chain(1000, full)}, std::pair{"chain", bench::chain(10000, full)},
              std::pair{"lattice", bench::lattice({8, 8, 6}, full)},
              std::pair{"lattice", bench::lattice({15, 15, 16}, full)},
              std::pair{"lattice, shuffled", bench::shuffled(bench::lattice({15, 15, 16}, full))}}) {
            Body body(model, {.damping_ratio = 0});
            const double h = 0.1 * body.stable_step();
            const auto per_link = [&](double time) { return 1e9 * time / body.link_count(); };
            const double plain = per_link(median([&] { body.step_explicit(h, 20); }) / 20);
            const double with_energy = per_link(median([&] {
                body.step_explicit(h);
                body.energy();
            }));
            body.set_damping({0, 1e-5});
            const double damped = per_link(median([&] { body.step_explicit(h, 20); }) / 20);
            fmt::print("| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} |\n", body.link_count(),
                       full ? "full, with volumes" : "the paper's", name, plain, damped, with_energy);
        }
    }
}

void print_organ() {
    const skeleton::Model model = bench::organ(200, 5);
    Body body(model);
    const int contact = body.touch(model.surface.vertices.row(0).transpose());
    const Vec3 from = model.surface.vertices.row(0);
    int tick = 0;
    const auto drag = [&] {
        const double phase = 0.01 * ++tick;
        body.drag(contact, from + Vec3(0, 3 * std::sin(phase), -5 + 5 * std::cos(phase)), 0.5);
    };
    const double implicit = median([&] {
        drag();
        body.step_implicit(1e-3);
    });
    const double skin = median([&] { body.skin(); });
    const double both = median([&] {
        drag();
        body.step_implicit(1e-3);
        body.skin();
    });
    fmt::print(
        "\nAn organ: {} spheres, {} full links with volumes, {} vertices, dragged at a point\n\n"
        "| | ms | Hz |\n| --- | --- | --- |\n"
        "| implicit step of 1 ms | {:.3f} | {:.0f} |\n| skinning | {:.3f} | {:.0f} |\n| both | {:.3f} | {:.0f} |\n",
        body.sphere_count(), body.link_count(), body.vertex_count(), 1e3 * implicit, 1 / implicit, 1e3 * skin, 1 / skin,
        1e3 * both, 1 / both);
}

struct Ticks {
    double median, late, longest;  // of a step, late: 99 of 100 are shorter [s]
};

// Steps of a millisecond, each after `move`.
Ticks ticks(Body& body, const std::function<void(int tick)>& move) {
    std::vector<double> each;
    for (int tick = 0; tick < 4000; ++tick) {
        each.push_back(seconds([&] {
            move(tick);
            body.step_implicit(1e-3);
        }));
    }
    std::ranges::sort(each);
    return {each[each.size() / 2], each[each.size() * 99 / 100], each.back()};
}

// A hand drags a point of the top in and about, or a ball presses there and slides, as deep and as far.
void print_tools() {
    fmt::print(
        "\nSteps of 1 ms with a ball that presses 3 mm in and slides over 10 mm of the top, twice a second, and with "
        "a\n"
        "point that is dragged alike\n\n"
        "| spheres | skin | dragged, median ms | 99 % | longest | ball, median ms | 99 % | longest | of the dragged |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (const auto& [spheres, halvings] : {std::pair{40, 4}, std::pair{200, 5}}) {
        const skeleton::Model model = bench::organ(spheres, halvings);
        const Vec3 top(0, 0, model.surface.vertices.col(2).maxCoeff());
        const auto way = [&](int tick) {
            const double phase = 2 * 3.14159265 * 2e-3 * tick;
            return Vec3(5 * std::sin(phase), 0, -1.5 + 1.5 * std::cos(2 * phase));
        };
        Body body(model);
        const int contact = body.touch(top);
        const Ticks dragged = ticks(body, [&](int tick) { body.drag(contact, top + way(tick), 0.5); });
        body.reset();
        constexpr double radius = 8;
        const int ball = body.add_ball(radius);
        const Ticks pressed = ticks(body, [&](int tick) {
            body.place_tool(ball, top + Vec3(0, 0, radius) + way(tick));
            body.tool_load(ball);
        });
        fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |\n", body.sphere_count(),
                   body.vertex_count(), 1e3 * dragged.median, 1e3 * dragged.late, 1e3 * dragged.longest,
                   1e3 * pressed.median, 1e3 * pressed.late, 1e3 * pressed.longest, pressed.median / dragged.median);
    }
}

void print_equilibria() {
    fmt::print(
        "\nEquilibrium after a load step (displacement about 5 % of the body)\n\n"
        "| links | kind | body | Newton steps | ms | skeleton/ (StaticsSolver) ms |\n"
        "| --- | --- | --- | --- | --- | --- |\n");
    for (const bool full : {false, true}) {
        for (const auto& [name, plain] :
             {std::pair{"chain", bench::chain(1000, full)}, std::pair{"lattice", bench::lattice({8, 8, 6}, full)},
              std::pair{"lattice", bench::lattice({20, 6, 4}, full)}}) {
            const skeleton::Model model = bench::with_skin_on_spheres(plain);
            const Vec3 force = bench::force_for(model, 0.05);
            Body body(model);
            const int contact = body.touch(model.surface.vertices.bottomRows(1).transpose());
            int steps = 0, sign = 1;
            const double time = median([&] {
                body.push(contact, 0.5 * (1 + sign) * force);
                sign = -sign;
                steps = body.equilibrium().iterations;
            });
            skeleton::StaticsSolver solver(model);
            const Eigen::VectorXd k = skeleton::stiffness_vector(model);
            skeleton::Load loads[2];
            for (int i = 0; i < 2; ++i) loads[i].forces.push_back({model.skin.back(), i * force});
            skeleton::Equilibrium at = solver.solve(k, loads[0]);
            const double slow = median([&] {
                at = solver.solve(k, loads[sign > 0 ? 1 : 0], {}, &at);
                sign = -sign;
            });
            fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} |\n", body.link_count(),
                       full ? "full, with volumes" : "the paper's", name, steps, 1e3 * time, 1e3 * slow);
        }
    }
}

void print_conservation(int steps) {
    fmt::print(
        "\nEnergy and momenta over {} explicit steps, undamped, at a tenth of the stable step; a free lattice of\n"
        "3 x 3 x 3 spheres set off at random (kinetic and elastic energy come to be equal)\n\n"
        "| links | steps | energy, largest departure | its mean over the last tenth | linear momentum | angular |\n"
        "| --- | --- | --- | --- | --- | --- |\n",
        steps);
    for (const bool full : {false, true}) {
        Body body(bench::free(bench::lattice({3, 3, 3}, full)), {.damping_ratio = 0});
        bench::set_off(body, 500, 50);
        const double h = 0.1 * body.stable_step();
        const runtime::Energy start = body.energy();
        const runtime::Momenta before = body.momenta();
        const double total = start.kinetic + start.potential;
        double most = 0, late = 0;
        for (int tenth = 1; tenth <= 10; ++tenth) {
            late = 0;
            for (int i = 0; i < 100; ++i) {
                body.step_explicit(h, steps / 1000);
                const runtime::Energy now = body.energy();
                const double off = (now.kinetic + now.potential) / total - 1;
                most = std::max(most, std::abs(off));
                late += off / 100;
            }
            const runtime::Momenta now = body.momenta();
            if (tenth != 1 && tenth != 10) continue;
            fmt::print("| {} | {} | {:.1e} | {:+.1e} | {:.1e} | {:.1e} |\n",
                       full ? "full, with volumes" : "the paper's", tenth * (steps / 10), most, late,
                       (now.linear - before.linear).norm() / before.linear.norm(),
                       (now.angular - before.angular).norm() / before.angular.norm());
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 1'000'000;
    print_steps();
    palpate::bench::print_bullet();
    print_organ();
    print_tools();
    print_equilibria();
    print_conservation(steps);
}
