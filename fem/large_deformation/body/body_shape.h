#pragma once

#include <memory>

#include "fem/effects/effects.h"
#include "fem/elements/dilatation.h"
#include "fem/large_deformation/body/body_points.h"
#include "fem/large_deformation/body/element_regions.h"
#include "fem/large_deformation/body/node_integrals.h"
#include "fem/large_deformation/body/node_weights.h"
#include "fem/large_deformation/elements/element_kernel.h"
#include "fem/large_deformation/lazy.h"
#include "fem/large_deformation/loads/cavities.h"
#include "fem/large_deformation/loads/placed_tendon.h"
#include "fem/large_deformation/loads/skin.h"

namespace palpate::fem {

/// What a body is, whatever it is made of.
struct BodyShape {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    Dilatation dilatation;
    std::vector<ElementShape> elements;
    NodeIntegrals integrals;
    Cavities cavities{};
    std::shared_ptr<const Lazy<Skin>> lazy_skin = std::make_shared<Lazy<Skin>>();  // few bodies have effects in it
    std::shared_ptr<const Lazy<BodyPoints>> lazy_boundary = std::make_shared<Lazy<BodyPoints>>();
    std::shared_ptr<const Lazy<BodyPoints>> lazy_nodes = std::make_shared<Lazy<BodyPoints>>();
    std::shared_ptr<const TendonPaths> tendon_paths = std::make_shared<TendonPaths>();
    ElementRegions regions{};

    const Skin& skin() const;
    const BodyPoints& boundary_points() const;
    const BodyPoints& node_points() const;
    /// Pressure in each cavity (of their number) [MPa].
    Eigen::VectorXd pressures(const Effects& effects) const;
    NodeWeights points(ActsOn what, double density) const;
    /// Where an element's quadrature points rest (points x 3) [mm].
    PointPositions quadrature_points(std::size_t element) const;
    /// Displacements of an element's nodes.
    NodeVectors displacements(const Eigen::VectorXd& u, std::size_t element) const;
    /// Adds forces on an element's nodes to those on all.
    void add(const NodeVectors& f, std::size_t element, Eigen::Ref<Eigen::VectorXd> forces) const;
};

}  // namespace palpate::fem
