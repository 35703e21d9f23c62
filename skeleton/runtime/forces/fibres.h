#pragma once

#include "skeleton/links/placed/placed_links.h"
#include "skeleton/runtime/forces/poses.h"

namespace palpate::runtime {

/// The effects in the links that are no mere stiffness: of the material along the links' fibres, and shear. The laws
/// are those of PlacedLinks.
class Fibres {
public:
    /// `lengths`: of each link's fibres; `k`: of each, scaled; `laws`: of each, or none. What acts by a link's law is
    /// not in its fibres.
    Fibres(const skeleton::Model& model, const fem::Effects& effects,
           const std::vector<skeleton::FibreLengths>& lengths, const std::vector<skeleton::Stiffnesses>& k,
           const std::vector<skeleton::SectionLaw>& laws);

    /// Does one of the effects act in a link beside its stiffnesses and its law?
    static bool needed(const skeleton::Model& model, const fem::Effects& effects,
                       const std::vector<skeleton::SectionLaw>& laws);

    /// Adds their forces to the spheres' rows; returns their energy [N mm].
    double add_forces(const Poses& poses, double* force) const;
    /// Adds the second derivative of a link's.
    void add_hessian(std::size_t link, const Poses& poses, skeleton::Mat12& H) const;

    bool remember() const { return static_cast<bool>(history_); }
    void settle(const Poses& poses);
    void forget();

private:
    struct OfLink {
        int a = 0, b = 0;
        double length = 0, shear = 0;  // [mm], [N/mm]
        bool by_law = false;           // its section has a law
        Vec3 direction, middle;        // at rest
        skeleton::FibreOffsets offsets;
        skeleton::FibreLengths lengths;                                 // where nothing strains them [mm]
        Eigen::Matrix<double, skeleton::fibres_per_link, 1> strengths;  // [N/mm]
    };
    skeleton::LinkFibre fibre(const OfLink& link, int j, const Poses& poses) const;
    skeleton::StretchTerms terms(std::size_t link, int j, double stretch, bool with_second) const;

    std::vector<std::shared_ptr<const fem::MaterialEffect>> material_;
    std::vector<char> in_sections_;  // of each: it acts by the law of a section that has one
    skeleton::HistoryLaw history_;
    std::vector<OfLink> links_;
    skeleton::FibreStates borne_;
};

}  // namespace palpate::runtime
