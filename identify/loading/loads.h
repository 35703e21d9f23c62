#pragma once

#include <memory>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/core/contact.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

/// Turns contacts on the body into forces on a skeleton's skin.
///
/// A contact's force is spread evenly over the skin within its radius, sampled finely, and acts on the mean of the
/// samples: their attachments blended into one. Where no sample lies within (radius 0, or a small one), it acts at the
/// nearest point of the skin. A model without a skin takes it where it is told to act.
class ContactLoads {
public:
    explicit ContactLoads(const skeleton::Model& model);
    ~ContactLoads();

    skeleton::Load operator()(const std::vector<mesh::Contact>& contacts, const Vec3& gravity = Vec3::Zero()) const;
    /// What is known to act in a state of a set; gravity that is not known is none, and pressure acts in cavities only.
    skeleton::Load operator()(const MeasurementSet& set, const LoadState& state) const;

private:
    const skeleton::Model& model_;
    skeleton::Attacher attach_;
    std::unique_ptr<mesh::SurfaceTree> tree_;
    std::shared_ptr<const skeleton::Cavities> cavities_;  // of the skin; null: it has none
};

/// The load that acts at a time > 0 of a motion, of a probe's in their order: each acts from the one before it up to
/// its own time, the last one to the end. @pre there is one
const LoadState* acting_at(const std::vector<const LoadState*>& loads, double time);
/// What acted before the beginning: the first of several, if its time is 0; else nothing, null.
const LoadState* acting_before(const std::vector<const LoadState*>& loads);

/// Does an effect of the model pull at it whatever else acts, as its weight does?
bool is_always_loaded(const skeleton::Model& model);

/// Pressure known to act in a state's cavities [MPa]; unknown is none.
double known_pressure(const LoadState& state);

/// Gravity known to act in a state: the state's own, else the set's, else none.
std::optional<Vec3> known_gravity(const MeasurementSet& set, const LoadState& state);

/// Is a tool elsewhere than where it rests? What is left free does not count.
bool is_off_rest(const mesh::ToolMotion& motion);

/// Does a force, gravity, pressure, tool or actuator act in a state, as far as is known?
bool is_known_to_act(const MeasurementSet& set, const LoadState& state);

}  // namespace palpate::identify
