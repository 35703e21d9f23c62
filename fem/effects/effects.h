#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "fem/effects/material/growth.h"
#include "fem/effects/material/material_effect.h"
#include "fem/effects/point/point_potential.h"
#include "fem/effects/surface/surface_energy.h"
#include "fem/rig/actuation.h"

namespace palpate::fem {

/// The material yields: J2 plasticity in large strain with linear isotropic hardening. [Simo & Hughes 1998, box 9.1]
/// Stresses are shares of the shear modulus mu, so that another stiffness leaves the strains as they are.
struct Plasticity {
    double yield = 0;      // Mises stress of first yield / (3 mu): the equivalent strain there [-], > 0
    double hardening = 0;  // d Mises stress / d equivalent plastic strain / (3 mu) [-], >= 0
};

/// The material is softer after its first large strain (the Mullins effect): damage_energy. What it bears while it is
/// strained further than ever stays as it is without.
struct Damage {
    double share = 0;   // of its resistance to distortion that it may lose [-], 0 <= share < 1
    double strain = 1;  // equivalent strain which leaves it a good deal softer [-], > 0
};

/// The material creeps: under a load that is held since time 0 its compliance grows as
///   J(t) / J(0) = 1 + creep (1 - exp(-t / tau)),
/// all moduli alike, so that a body bears loads as an elastic one bears them times J.
struct CreepLaw {
    double creep = 0;  // [-], >= 0
    double tau = 1;    // [s], > 0
};

/// An effect specific to one kind of model; ignored by solids.
class ModelSpecificEffect {
public:
    virtual ~ModelSpecificEffect() = default;
    virtual bool is_nothing() const = 0;  // all its numbers are 0
};

class ToolPotential;

/// What is in force on a body beyond its law and the forces of contacts.
struct Effects {
    std::vector<std::shared_ptr<const PointPotential>> points{};
    std::vector<std::shared_ptr<const MaterialEffect>> material{};
    SurfaceEnergies surface{};
    double pressure = 0;  // in closed cavities, above that outside [MPa]
    Growth growth{};
    std::optional<Plasticity> plasticity{};
    std::optional<Damage> damage{};
    std::optional<CreepLaw> creep{};  // used where loads are applied in time; ignored by an equilibrium
    std::vector<std::shared_ptr<const ModelSpecificEffect>> of_model{};
    std::vector<std::shared_ptr<const ToolPotential>> tools{};  // where they are
    std::vector<CavityPressure> cavities{};                     // besides `pressure`
    std::vector<TendonPull> tendons{};
    double tendon_friction = 0;  // coefficient, of all tendons [-]; those in `tendons` know their own

    bool empty() const {
        const auto is_nothing = [](const auto& effect) { return effect->is_nothing(); };
        return points.empty() && material.empty() && surface.empty() && pressure == 0 && growth.none() && !plasticity &&
               !damage && !creep && tools.empty() && cavities.empty() && tendons.empty() &&
               std::all_of(of_model.begin(), of_model.end(), is_nothing);
    }
    /// Does what the material has been through matter?
    bool remember() const { return plasticity || damage; }
    /// Puts others in force besides; numbers add up.
    void add(const Effects& more) {
        points.insert(points.end(), more.points.begin(), more.points.end());
        material.insert(material.end(), more.material.begin(), more.material.end());
        surface.insert(surface.end(), more.surface.begin(), more.surface.end());
        pressure += more.pressure;
        growth.add(more.growth);
        if (more.plasticity) plasticity = more.plasticity;
        if (more.damage) damage = more.damage;
        if (more.creep) creep = more.creep;
        of_model.insert(of_model.end(), more.of_model.begin(), more.of_model.end());
        tools.insert(tools.end(), more.tools.begin(), more.tools.end());
        cavities.insert(cavities.end(), more.cavities.begin(), more.cavities.end());
        tendons.insert(tendons.end(), more.tendons.begin(), more.tendons.end());
        tendon_friction += more.tendon_friction;
    }
};

/// Does one of them take the place of the supports?
inline bool release_supports(const Effects& effects) {
    for (const auto& potential : effects.points) {
        if (potential->acts_on() == ActsOn::support) return true;
    }
    return false;
}

}  // namespace palpate::fem
