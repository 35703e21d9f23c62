#include <exception>
#include <string>

#include "mesh/errors.h"
#include "skeleton/runtime/body.h"
#include "skeleton/runtime/palpate_runtime.h"

struct palpate_body {  // NOLINT(readability-identifier-naming): C's own name
    palpate::runtime::Body body;
};

namespace {

using Vec3Of = Eigen::Map<const Eigen::Vector3d>;

std::string& last_message() {
    thread_local std::string message;
    return message;
}

// Runs a call; what it throws becomes a status and a message.
template <typename Call>
palpate_status guarded(const Call& call) noexcept {
    const auto failed = [](const char* what, palpate_status status) {
        last_message() = what;
        return status;
    };
    try {
        call();
        return PALPATE_OK;
    } catch (const palpate::InvalidInput& e) {
        return failed(e.what(), PALPATE_BAD_INPUT);
    } catch (const palpate::IoError& e) {
        return failed(e.what(), PALPATE_BAD_INPUT);
    } catch (const palpate::SolverFailure& e) {
        return failed(e.what(), PALPATE_NO_SOLUTION);
    } catch (const std::exception& e) {
        return failed(e.what(), PALPATE_INTERNAL);
    }
}

template <typename Vector>
void copy(const Vector& from, double* to) {
    if (to) std::copy(from.data(), from.data() + from.size(), to);
}

}  // namespace

const char* palpate_message() { return last_message().c_str(); }

palpate_status palpate_open(const char* model, int contacts, palpate_body** body) {
    *body = nullptr;
    return guarded([&] {
        palpate::runtime::BodyOptions options;
        options.contacts = contacts;
        *body = new palpate_body{palpate::runtime::Body(std::filesystem::path(model), options)};
    });
}

void palpate_close(palpate_body* body) { delete body; }

const char* palpate_notice(const palpate_body* body, int i) {
    const auto& notices = body->body.notices();
    return i >= 0 && i < static_cast<int>(notices.size()) ? notices[i].c_str() : nullptr;
}

int palpate_sphere_count(const palpate_body* body) { return body->body.sphere_count(); }
int palpate_link_count(const palpate_body* body) { return body->body.link_count(); }
int palpate_vertex_count(const palpate_body* body) { return body->body.vertex_count(); }
int palpate_triangle_count(const palpate_body* body) { return static_cast<int>(body->body.triangles().size() / 3); }
const int* palpate_triangles(const palpate_body* body) { return body->body.triangles().data(); }

palpate_status palpate_reset(palpate_body* body) {
    return guarded([&] { body->body.reset(); });
}

palpate_status palpate_skin(palpate_body* body, const float** positions) {
    return guarded([&] { *positions = body->body.skin().data(); });
}

palpate_status palpate_sphere(const palpate_body* body, int sphere, double position[3], double orientation[4]) {
    return guarded([&] {
        copy(body->body.position(sphere), position);
        copy(body->body.orientation(sphere).coeffs(), orientation);
    });
}

palpate_status palpate_set_gravity(palpate_body* body, const double g[3]) {
    return guarded([&] { body->body.set_gravity(Vec3Of(g)); });
}

palpate_status palpate_set_damping(palpate_body* body, double alpha, double beta) {
    return guarded([&] { body->body.set_damping({alpha, beta}); });
}

palpate_status palpate_touch(palpate_body* body, const double point[3], double radius, int* contact) {
    return guarded([&] { *contact = body->body.touch(Vec3Of(point), radius); });
}

palpate_status palpate_release(palpate_body* body, int contact) {
    return guarded([&] { body->body.release(contact); });
}

palpate_status palpate_push(palpate_body* body, int contact, const double force[3]) {
    return guarded([&] { body->body.push(contact, Vec3Of(force)); });
}

palpate_status palpate_drag(palpate_body* body, int contact, const double to[3], double stiffness) {
    return guarded([&] { body->body.drag(contact, Vec3Of(to), stiffness); });
}

palpate_status palpate_contact(palpate_body* body, int contact, double force[3], double place[3]) {
    return guarded([&] {
        copy(body->body.force(contact), force);
        copy(body->body.place(contact), place);
    });
}

palpate_status palpate_add_ball(palpate_body* body, double radius, int* tool) {
    return guarded([&] { *tool = body->body.add_ball(radius); });
}

palpate_status palpate_add_punch(palpate_body* body, double radius, const double axis[3], int* tool) {
    return guarded([&] { *tool = body->body.add_punch(radius, Vec3Of(axis)); });
}

palpate_status palpate_place_tool(palpate_body* body, int tool, const double at[3], const double turn[4]) {
    return guarded([&] {
        const Eigen::Quaterniond q =
            turn ? Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(turn)) : Eigen::Quaterniond::Identity();
        body->body.place_tool(tool, Vec3Of(at), q);
    });
}

palpate_status palpate_lift_tool(palpate_body* body, int tool) {
    return guarded([&] { body->body.lift_tool(tool); });
}

palpate_status palpate_tool_load(palpate_body* body, int tool, double force[3], double moment[3]) {
    return guarded([&] {
        const palpate::runtime::ToolLoad load = body->body.tool_load(tool);
        copy(load.force, force);
        copy(load.moment, moment);
    });
}

palpate_status palpate_set_pressure(palpate_body* body, double pressure) {
    return guarded([&] { body->body.set_pressure(pressure); });
}

palpate_status palpate_find_cavity(palpate_body* body, const double point[3], int* cavity) {
    return guarded([&] { *cavity = body->body.find_cavity(Vec3Of(point)); });
}

palpate_status palpate_set_cavity_pressure(palpate_body* body, int cavity, double pressure) {
    return guarded([&] { body->body.set_cavity_pressure(cavity, pressure); });
}

palpate_status palpate_add_tendon(palpate_body* body, const double* path, int points, int* tendon) {
    using Path = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    return guarded([&] { *tendon = body->body.add_tendon(Eigen::Map<const Path>(path, points, 3)); });
}

palpate_status palpate_pull_tendon(palpate_body* body, int tendon, double tension) {
    return guarded([&] { body->body.pull_tendon(tendon, tension); });
}

palpate_status palpate_draw_tendon(palpate_body* body, int tendon, double length) {
    return guarded([&] { body->body.draw_tendon(tendon, length); });
}

palpate_status palpate_let_tendon_go(palpate_body* body, int tendon) {
    return guarded([&] { body->body.let_tendon_go(tendon); });
}

palpate_status palpate_tendon_tension(palpate_body* body, int tendon, double* tension) {
    return guarded([&] { *tension = body->body.tendon_tension(tendon); });
}

palpate_status palpate_stable_step(palpate_body* body, double* h) {
    return guarded([&] { *h = body->body.stable_step(); });
}

palpate_status palpate_step_explicit(palpate_body* body, double h, int steps) {
    return guarded([&] { body->body.step_explicit(h, steps); });
}

palpate_status palpate_step_implicit(palpate_body* body, double h) {
    return guarded([&] { body->body.step_implicit(h); });
}

palpate_status palpate_equilibrium(palpate_body* body) {
    return guarded([&] { body->body.equilibrium(); });
}

palpate_status palpate_energy(palpate_body* body, double* kinetic, double* potential) {
    return guarded([&] {
        const palpate::runtime::Energy energy = body->body.energy();
        *kinetic = energy.kinetic;
        *potential = energy.potential;
    });
}
