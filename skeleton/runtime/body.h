#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "skeleton/runtime/tools/tool_load.h"

namespace palpate::skeleton {
struct Model;
}

namespace palpate::runtime {

/// How motion dies away: forces -alpha m v on every sphere, and in every link beta times the rate of what it resists.
/// The second keeps momenta and turns with the body. A mode of angular frequency w has the damping ratio
/// (alpha / w + beta w) / 2.
struct RayleighDamping {
    double alpha = 0;  // [1/s], >= 0
    double beta = 0;   // [s], >= 0
};

struct [[gnu::visibility("default")]] BodyOptions {
    // Of the softest mode, by beta; >= 0. A body that nothing holds has none, and beta 0. Not told: damping as the
    // model has it, or else a ratio of 0.1.
    std::optional<double> damping_ratio = {};
    int contacts = 8;  // most at a time, in [0, 64]
    // Of the layer by which a tool presses, over that of the material (skeleton::layer_stiffness), in [1e-4, 10].
    double tool_compliance = 1;
    // Of implicit steps: how far off a sphere may be, as a share of the mean link length, in (0, 1).
    double step_tolerance = 1e-6;
    void validate() const;  // @throws InvalidInput naming option, value and bound
};

struct EquilibriumReport {
    int iterations = 0;
    double residual = 0;  // largest force left on a sphere, torques over the mean link length [N]
};

struct Energy {
    double kinetic = 0, potential = 0;  // [N mm]; potential: of links, effects and gravity, without contacts
};
struct Momenta {
    Eigen::Vector3d linear, angular;  // of the spheres that move; angular about the origin [tonne mm/s, tonne mm^2/s]
};

/// A calibrated model, alive: played at haptic and display rates, without allocating while it steps. Its laws are those
/// of the model in large rotation; its numbers do not depend on anything but what it was told (and, in the last digits,
/// on the processor's vector units). One thread at a time. Units: mm, N, s, tonne. Spheres and vertices are numbered as
/// in the model's file.
class [[gnu::visibility("default")]] Body {
public:
    /// @throws InvalidInput and IoError as read_model does, and when no effect of the model can be played.
    explicit Body(const std::filesystem::path& model, const BodyOptions& options = {});
    explicit Body(const skeleton::Model& model, const BodyOptions& options = {});
    ~Body();
    Body(Body &&) noexcept;
    Body& operator=(Body&&) noexcept;

    /// What of the model is not played as it stands, in words; mostly nothing.
    const std::vector<std::string>& notices() const;
    int sphere_count() const;
    int link_count() const;
    int vertex_count() const;

    // --- Where it is ---------------------------------------------------------------------------------------------
    /// Back to rest: at rest, without contacts, tools away and tendons let go, and as new.
    void reset();
    Eigen::Vector3d position(int sphere) const;
    Eigen::Quaterniond orientation(int sphere) const;
    void set_pose(int sphere, const Eigen::Vector3d& position, const Eigen::Quaterniond& orientation);
    void set_velocity(int sphere, const Eigen::Vector3d& linear, const Eigen::Vector3d& angular);
    Energy energy();
    Momenta momenta() const;

    /// The skin as it stands, with the dents that contacts and tools press into it: x, y, z of each vertex [mm].
    const std::vector<float>& skin();
    const std::vector<int>& triangles() const;  // three corners each, counter-clockwise seen from outside

    // --- Forces in, forces out -----------------------------------------------------------------------------------
    void set_gravity(const Eigen::Vector3d& g);  // beside the model's effects [mm/s^2]

    /// Takes hold of the skin at the point of it nearest to `point`, as it stands; with a radius over all of it that
    /// lies as near at rest [mm]. Allocates. The contact's number. @throws InvalidInput when all contacts are in use,
    /// or the model has no skin.
    int touch(const Eigen::Vector3d& point, double radius = 0);
    void release(int contact);
    /// Force in: a dead force on the contact [N].
    void push(int contact, const Eigen::Vector3d& force);
    /// The same, without creep of the body under this force.
    void push_without_creep(int contact, const Eigen::Vector3d& force);
    /// Position in: a spring from the contact to where it shall be; stiffness > 0 [N/mm].
    void drag(int contact, const Eigen::Vector3d& to, double stiffness);
    /// Force out: what acts on the body there, as it stands [N]; on a hand that drags it, minus that.
    Eigen::Vector3d force(int contact);
    /// Effective force there [N]: for a creeping body, the instantaneous force that would hold its current
    /// configuration.
    Eigen::Vector3d effective_force(int contact);
    Eigen::Vector3d place(int contact);  // [mm]

    // --- Rigid tools, which press on the skin without friction ----------------------------------------------------
    /// A ball. The tool's number; it is away until it is placed. Adding a tool allocates, and so does one that touches
    /// more of the body than any before. @throws InvalidInput for a radius that is not above 0, or a model without a
    /// skin.
    int add_ball(double radius);
    /// The flat face of a round punch that presses along `axis`.
    int add_punch(double radius, const Eigen::Vector3d& axis);
    /// Moves a tool there. From one step to the next it may move by a quarter of its radius: what goes farther at once
    /// may come out at the other side of the body.
    void place_tool(int tool, const Eigen::Vector3d& at,
                    const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());
    void lift_tool(int tool);  // away
    /// What it does to the body as it stands; what a hand feels that moves it is the contrary. 0 where it is away.
    ToolLoad tool_load(int tool);

    // --- Actuation ------------------------------------------------------------------------------------------------
    /// In the cavities that the skin encloses, beside the model's effects [MPa]. Allocates the first time.
    /// @throws InvalidInput when there are none.
    void set_pressure(double pressure);
    /// The number of the cavity with a wall nearest to a point at rest. @throws InvalidInput when there is none.
    int find_cavity(const Eigen::Vector3d& point) const;
    /// In one cavity [MPa]. @throws InvalidInput when there is no such one.
    void set_cavity_pressure(int cavity, double pressure);
    /// A cable through points of the body (p x 3) [mm]: the first is fixed in space, the last to the body. Let go until
    /// it is pulled. Allocates. @throws InvalidInput for less than two points, or two next to each other in one place.
    int add_tendon(const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& path);
    void pull_tendon(int tendon, double tension);  // >= 0 [N]
    void draw_tendon(int tendon, double length);   // in, from its length at rest; it may go slack; >= 0 [mm]
    void let_tendon_go(int tendon);
    double tendon_tension(int tendon);  // as the body stands [N]

    // --- In time -------------------------------------------------------------------------------------------------
    void set_damping(const RayleighDamping& damping);
    const RayleighDamping& damping() const;
    /// Largest explicit step that is stable at rest, without contacts [s].
    double stable_step();
    /// `steps` steps of h by a symplectic rule of second order (drift, kick, drift). @throws InvalidInput when a
    /// sphere that moves has no mass, or while a tool is placed or a tendon pulls, which are too
    /// stiff for this rule.
    void step_explicit(double h, int steps = 1);
    /// One step of h by the implicit Euler rule, stable at any h. Factorisations serve on for as long as they lead to
    /// the answer. @throws SolverFailure when Newton's method does not end; the body stays as it was.
    void step_implicit(double h);
    /// To where all forces vanish, from where it is; at rest then. At once: nothing creeps meanwhile.
    /// @throws SolverFailure when there is no such place, or nothing holds the body.
    EquilibriumReport equilibrium();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::runtime
