#pragma once

#include <string>
#include <vector>

#include "fem/rig/rigid_shape.h"
#include "mesh/core/tool.h"
#include "skeleton/runtime/body.h"
#include "skeleton/runtime/contacts/creep.h"
#include "skeleton/runtime/kernels/skinning.h"
#include "skeleton/runtime/solver/solver.h"
#include "skeleton/runtime/tools/rig.h"
#include "skeleton/runtime/walk_order.h"

namespace palpate::runtime {

struct Body::Impl {
    BodyOptions options;
    ReorderedModel reordered;
    ForceField field;
    Rig rig;
    Solver solver;
    Skinning skinning;
    MassTable masses;
    std::vector<std::string> notices;
    SphereRows rest, pose, start, momentum, velocity, force;
    std::vector<ContactState> contacts;
    std::vector<ContactState*> in_use;  // all contacts, as the solver wants them
    CreepIntegrator creep;
    std::vector<float> skin;
    std::vector<int> triangles;
    RayleighDamping damping;
    double stable = 0;  // [s]; 0: not known yet
    bool held = false;
    int massless = -1;  // a sphere that moves and has no mass, by its number in the file

    Impl(const skeleton::Model& model, const BodyOptions& how);

    /// Those in use, placed. @throws InvalidInput for a number that is not.
    ContactState& contact(int number);
    /// @throws InvalidInput for numbers and values that are not allowed.
    void require_tool(int number) const;
    void require_tendon(int number, double value) const;
    void require_masses() const;
    void require_time(double h) const;
    /// Where a sphere's row begins.
    int row(int sphere) const;
    int add_tool(const mesh::Tool& tool, const std::shared_ptr<const fem::RigidShape>& shape, double extent);

    /// Forces where it stands, with those of contacts; rates by the momenta.
    void evaluate();
    /// Momenta of a sphere that moves by v and w.
    void set_momentum(int place, const Vec3& v, const Vec3& w);
    /// Velocities and momenta of a step of h from `start` to `pose`.
    void set_momenta(double h);
    void begin_step(double h);
    void end_step(double h);
    [[noreturn]] void fail(const char* what, const Solver::Report& report) const;
};

}  // namespace palpate::runtime
