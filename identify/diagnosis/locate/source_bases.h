#pragma once

#include <optional>
#include <vector>

#include "identify/diagnosis/locate/missing_source.h"
#include "identify/diagnosis/locate/reading_adjoints.h"

namespace palpate::identify {

/// A part of the body that a source may lie in: a Gaussian weight about a centre.
struct SourcePlace {
    Vec3 centre = Vec3::Zero();
    double radius = INFINITY;  // [mm]
    double extent = 0;         // rms distance of the weight from its centroid [mm]
    double norm = 1;           // sum of the weight by shares
    double log_prior = 0;      // of this place among all: radii are equally likely, and places of one radius
    Vec3 axis = Vec3::Zero();  // of fibres; into the body, of the skin there
    int number = -1;           // of a marker or probe
};

/// Sources of one form in all places: what the readings feel of a unit of each of p numbers there.
struct SourceBasis {
    SourceKind kind = SourceKind::body_force;
    SourceForm form = SourceForm::force;
    int width = 1;  // numbers of a place (p)
    bool one_sided = false;
    /// The law that its columns hold already; absent: any that is alike at all places.
    std::optional<SourceLaw> law = {};
    std::vector<SourcePlace> places = {};
    Eigen::MatrixXd columns = {};  // of the entries, over sigma (entries x places p)
};

/// All forms that the model and the problem allow, at the configurations of a fit.
std::vector<SourceBasis> source_bases(const BodyModel& model, const Problem& problem, const Refit& fit,
                                      const std::vector<ReadingEntry>& entries, int threads);

}  // namespace palpate::identify
