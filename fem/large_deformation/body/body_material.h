#pragma once

#include <optional>

#include "fem/large_deformation/body/body_shape.h"
#include "fem/large_deformation/body_setting.h"
#include "fem/large_deformation/elements/element_effects.h"

namespace palpate::fem {

/// What every quadrature point of a body has been through.
struct MaterialState {
    MaterialLaw law;                    // what it was found with, and goes with
    std::vector<MaterialPoint> points;  // that of point q in element e is 4 e + q
};

/// What a body is made of: how each of its elements answers, with the effects in its material.
///
/// Material that has grown by a factor g in every free length, in an element as at its middle, has the energy g^3 W(F /
/// g) per volume of the rest shape: an element answers as it does without growth to nodes at x / g, with forces g^2 as
/// large. In small strain its strain is less by g - 1. [Rodriguez, Hoger, McCulloch 1994]
class BodyMaterial {
public:
    /// `before`: nullptr: virgin; of no account where nothing remembers. `flows`: does plastic strain change from
    /// there?
    /// @pre body, effects and `before` outlive it. @throws InvalidInput for plasticity or damage out of range.
    BodyMaterial(const BodyShape& body, const BodySetting& setting, const MaterialState* before = nullptr,
                 bool flows = true);
    BodyMaterial(const BodyMaterial&) = delete;
    BodyMaterial& operator=(const BodyMaterial&) = delete;

    /// Other moduli, of all regions; effects in the material are shares of mu still.
    void set_moduli(double mu, double K) {
        for (ElementModel& model : models_) model.mu = mu, model.K = K;
    }
    MaterialLaw law() const { return models_.front().law; }
    /// Are its forces the gradient of a potential?
    bool conservative() const { return !(plasticity_ && flows_); }

    /// Energy and internal forces of an element; infinite where it is inside out.
    double force(const Eigen::VectorXd& u, std::size_t element, NodeVectors& f) const;
    /// The forces alone. @throws SolverFailure when the element is inside out.
    NodeVectors force(const Eigen::VectorXd& u, std::size_t element) const;
    /// @pre the element is not inside out.
    void tangent(const Eigen::VectorXd& u, std::size_t element, ElementTangent& K) const;

    /// What the body has been through once it has stood in u.
    MaterialState after(const Eigen::VectorXd& u) const;

    /// Shear modulus times volume, which energies are small differences of [N mm].
    double energy_scale() const;
    /// About the norm of what rounding leaves of forces that balance in the displacement u [N].
    double rounding(const Eigen::VectorXd& u) const;

private:
    const ElementModel& model(std::size_t element) const { return models_[body_.regions.group(element)]; }
    const ElementEffects* effects(std::size_t element) const {
        return place_.empty() || place_[element] < 0 ? nullptr : &effects_[place_[element]];
    }

    /// g of an element, 1 in small strain: its energy is g^3 times that without growth, its forces are g^2 times those.
    double scale(std::size_t element) const {
        return growth_.empty() || law() == MaterialLaw::linear ? 1 : 1 + growth_[element];
    }
    /// Displacements of an element's nodes from the shape that it would have by itself, scaled to that of its rest.
    NodeVectors elastic_displacements(const Eigen::VectorXd& u, std::size_t element) const;

    const BodyShape& body_;
    std::vector<ElementModel> models_;  // of the body's own material, then of each region's
    std::vector<double> growth_;        // g - 1 of each element; empty: none has grown
    std::vector<const MaterialEffect*> energies_;
    std::optional<Plasticity> plasticity_;
    std::optional<Damage> damage_;
    const MaterialState* before_;
    bool flows_;
    std::vector<int> place_;  // of each element among effects_, -1: it has none; empty: no element has any
    std::vector<ElementEffects> effects_;
};

}  // namespace palpate::fem
