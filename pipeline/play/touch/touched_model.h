#pragma once

#include <optional>
#include <vector>

#include "identify/loading/loads.h"
#include "mesh/core/actuator.h"
#include "skeleton/runtime/body.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::pipeline {

/// A model under a hand, driven by actuators: the runtime's body, and what a page asks of it beyond. Contacts are
/// places on the skin at rest, so that they outlive a change of the model.
class TouchedModel {
public:
    /// A contact, as it can be made again on another body of the same skin.
    struct Touch {
        int contact = -1;            // of the body; -1: free
        Vec3 rest = Vec3::Zero();    // [mm]
        double radius = 0;           // [mm]
        bool drags = false;          // a spring; else a dead force
        bool creeps = true;          // the body under it, if it can
        Vec3 vector = Vec3::Zero();  // where the spring leads [mm], or the force [N]
        double stiffness = 0;        // of the spring [N/mm]
    };
    static constexpr int most_touches = 16;

    /// A rigid ball that presses on the skin.
    struct Ball {
        int tool = -1;           // of the body; -1: there was none yet
        double radius = 0;       // [mm]
        bool is_placed = false;  // else it is away
        Vec3 at = Vec3::Zero();  // [mm]
    };

    /// `gravity` [mm/s^2] and `pressure` [MPa] are known to act beside the model's effects. @throws as runtime::Body.
    TouchedModel(skeleton::Model model, const Vec3& gravity, double pressure);

    runtime::Body& body() { return body_; }
    const skeleton::Model& model() const { return model_; }
    const std::vector<Touch>& touches() const { return touches_; }

    /// Stands and is touched as another one of the same spheres and skin.
    void take_over(const TouchedModel& other);
    /// At rest, untouched, actuators at 0.
    void reset();

    /// Takes hold of the skin at rest. @return the number of the touch, to be used below. @throws InvalidInput when all
    /// are in use.
    int touch(const Vec3& rest, double radius);
    void release(int touch);
    void push(int touch, const Vec3& force);
    void push_without_creep(int touch, const Vec3& force);  // without creep
    void drag(int touch, const Vec3& to, double stiffness);
    Vec3 force(int touch);            // on the body [N]
    Vec3 effective_force(int touch);  // as runtime::Body has it [N]
    Vec3 place(int touch);            // [mm]

    /// Brings a ball to a place; there is one at a time. @throws as runtime::Body::add_ball.
    void place_ball(double radius, const Vec3& at);
    void lift_ball();
    Vec3 ball_force();  // on the body [N]

    /// Something that drives the body from inside; at first it does nothing. Its number. @throws as
    /// runtime::Body::add_tendon; InvalidInput for pressure where the skin encloses no cavity.
    int add_actuator(const mesh::Actuator& actuator);
    /// Pressure [MPa], tension [N] or length drawn in [mm].
    void drive(int actuator, double value);
    double tension(int actuator);  // of a tendon as the body stands [N]

    /// h seconds on; in smaller steps where one does not end. @throws SolverFailure when these do not either.
    void advance(double h);

    /// How the place of a touch gives way to small forces there, all else acting on as it does: d place / d force, from
    /// the tangent as the body stands [mm/N]. None where the body is not stable as it stands.
    std::optional<Mat3> compliance(int touch);

    void stand_as(const skeleton::State& state);
    skeleton::State state() const;
    /// What acts at the touches, as `palpate simulate` takes it.
    skeleton::Load load();
    /// Attached points as the body stands, with the dents that the touches press (m x 3) [mm].
    Points places(const std::vector<skeleton::Attachment>& points);

private:
    struct Driven {
        mesh::Actuator actuator;
        int number = 0;    // of the body's cavity or tendon
        double value = 0;  // as drive() has it
    };
    Touch& at(int touch);
    Driven& driven(int actuator);
    /// The actuators as effects on the statics.
    fem::Effects driven_effects() const;

    skeleton::Model model_;
    runtime::Body body_;
    identify::ContactLoads to_load_;
    std::optional<skeleton::StaticsSolver> solver_;  // none: the actuators act otherwise since
    Eigen::VectorXd k_;
    std::vector<Touch> touches_;
    Ball ball_;
    std::vector<Driven> actuators_;
    std::vector<skeleton::Load> unit_loads_;  // of touches, each 1 N
    Vec3 gravity_;
};

}  // namespace palpate::pipeline
