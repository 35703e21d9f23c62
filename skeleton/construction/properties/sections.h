#pragma once

#include <vector>

#include "fem/material.h"
#include "skeleton/construction/properties/link_kind.h"
#include "skeleton/construction/shape/cells.h"
#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Where two cells meet: the section of the body that a link stands for.
struct Section {
    int a = 0, b = 0;                   // sites, a < b
    double length = 0;                  // between them [mm]
    double area = 0;                    // seen along the link [mm^2]
    double moment_1 = 0, moment_2 = 0;  // second moments about its centroid, larger and smaller [mm^4]
    double dimensions = 3;              // of the body there: 1 limb, 2 plate, 3 lump
    Vec3 centroid = Vec3::Zero();       // [mm]
    Mat3 axes = Mat3::Identity();       // rows: along the link; across it, where the section reaches far, and where not

    bool is_lump() const { return dimensions >= 2.5; }
};

/// Of the mean area: what is smaller is a sliver, and carries no link.
inline constexpr double sliver = 0.05;

/// The sections between all pairs of cells that meet, but for slivers that no connection depends on, and for pairs of
/// held sites.
std::vector<Section> find_sections(const TetGraph& graph, const Core& core, const std::vector<int>& owner,
                                   const std::vector<Site>& sites);

/// Radius of gyration of a section [mm]: in bending as start_stiffness has it, of a lump the mean of all axes.
double radius_of_gyration(const Section& section);

/// Stiffness of a link from its section, before anything is measured: of the paper's link, or of a full one.
Stiffnesses start_stiffness(const Section& section, const fem::Material& material, LinkKind kind);

}  // namespace palpate::skeleton
