#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnosis/problem.h"

namespace palpate::identify {

/// What kind of thing is missing, whatever its name.
enum class SourceKind {
    body_force,  // a force within the material, or growth of it
    stiffness,   // the material is stiffer or softer than the model's: somewhere, along some direction, or at times
    boundary,    // a force on the surface where the model has none, or a support that moves
    sensor,      // readings are off, the body is not
};
inline constexpr std::array<const char*, 4> source_kind_names{"body-force", "stiffness", "boundary", "sensor"};

/// How the strength of a source depends on what acts.
enum class SourceLaw {
    constant,      // alike in all states
    proportional,  // to the load
    quadratic,     // with the square of the load
    with_time,     // with the logarithm of the time since the probe began
    with_history,  // with the largest load so far
    spring,        // against the body's own motion there
    one_sided,     // against its motion outward there, beyond a gap, never inward
    with_strain,   // with the elastic energy that the material holds there in the state
    reaction,      // with the force on the supports
    one_probe,     // in one probe alone
    some_states,   // alike in some states, and not in the others
    irregular,     // a strength of its own in each state
};
inline constexpr std::array<const char*, 12> source_law_names{"constant", "proportional", "quadratic",   "time",
                                                              "history",  "spring",       "one-sided",   "strain",
                                                              "reaction", "one-probe",    "some-states", "irregular"};

/// What a source's numbers are.
enum class SourceForm {
    force,      // a force in the material [N] (3)
    growth,     // of every free length of the material [-] (1)
    softening,  // ln of the stiffness over the model's [-]; with the strain, at the largest mean energy of a state (1)
    fibres,     // stiffness along a direction, a share of the shear modulus [-] (1)
    set,        // share of earlier loads that the body keeps the shape of, linear and quadratic [-] (2)
    traction,   // a force on the skin [N] (3)
    normal,     // a force on the skin along its normal, inward positive [N]; a stiffness [N/mm] of springs (1)
    support,    // compliance of the supports: moving [mm/N] and turning [rad/(N mm)] (2)
    marker,     // how far readings of a marker are off [mm] (3)
    frame,      // how far the frame of the readings has moved and turned [mm], [rad] (6)
    gain,       // how much larger a probe's force is than it is told [-] (1)
    gains,      // the same of each probe (probes)
    readings,   // single readings that are off, each by itself; it has no numbers
};

/// Is it a force or a shift, which has a direction?
bool is_vector(SourceForm form);

/// One way to explain what is left: where it is, how strong, how likely among those of its kind.
struct SourceTerm {
    SourceForm form = SourceForm::force;
    SourceLaw law = SourceLaw::constant;
    Vec3 centre = Vec3::Zero();  // of its weight in the body [mm]
    double radius = INFINITY;    // 1 sd of a Gaussian weight [mm]; infinite: everywhere
    double extent = 0;           // rms distance of that weight from the centre [mm]
    double norm = 1;             // that weight summed over the body or its skin, by their shares
    Vec3 axis = Vec3::Zero();    // of fibres, or into the body; 0: none
    double gap = 0;              // under one_sided: how far the skin moves outward before it is met [mm]
    int number = -1;             // of the marker (of the set) or probe (as in the set); -1: none
    double log_bayes_factor = 0, probability = 0;
    Eigen::VectorXd mean = {}, sd = {};  // its numbers (p)
    Eigen::MatrixXd covariance = {};     // (p x p)
    Eigen::VectorXd strength = {};       // of each state: what the numbers are multiplied by (S)
};

/// What is left of the readings, located: which kind of source explains it best, where it is, in which states it acts
/// and how it goes with the load; whatever its name, inside of any catalogue or not.
struct MissingSource {
    SourceKind kind = SourceKind::body_force;
    std::array<double, 4> log_bayes_factors{};  // of each kind, against nothing
    std::vector<SourceTerm> terms = {};         // of that kind, the likeliest first
    Vec3 at = Vec3::Zero();                     // [mm]
    double spread = 0;              // rms distance of where it may be, and of how far it reaches, from there [mm]
    Vec3 direction = Vec3::Zero();  // of unit length; 0: it has none
    double direction_sd = 0;        // [rad]
    std::vector<int> states = {};   // of the set, in which it shows: a fifth or more of the most
    /// Where each form of source is likeliest, under each law that it may follow: in one or two places far apart, and
    /// all over the body; the likeliest first.
    struct Rival {
        SourceKind kind;
        SourceTerm term;
        double log_weight;  // ln of evidence and prior, to first order
    };
    std::vector<Rival> rivals = {};
    double explained = 0;  // share of the whitened square error that the likeliest term takes away

    double log_bayes_factor() const { return log_bayes_factors[static_cast<std::size_t>(kind)]; }
    const SourceTerm& likeliest() const { return terms.front(); }
    /// Length of the likeliest term's numbers, or the number, with its standard deviation and unit.
    struct Magnitude {
        double value = 0, sd = 0;
        const char* unit = "1";
    };
    std::optional<Magnitude> magnitude() const;
    /// The likeliest term in a sentence, with what it cannot tell.
    std::string sentence() const;
};

/// Density of a source over some points in a state, averaged over its terms, and its standard deviation: forces per
/// share of the body or of its skin (n x 3) [N], or scalars in the first column.
struct SourceField {
    Points mean;
    Eigen::VectorXd sd;
};
SourceField field_of(const MissingSource& source, const Points& points, int state);

/// Weight of a source at some points (n).
Eigen::VectorXd source_weight(const Vec3& centre, double radius, const Points& points);

/// Where some weight over points is (n): its sum, its centroid, and its rms distance from there [mm].
struct WeightPlace {
    double norm = 0;  // if that is 0, the others are not known
    Vec3 centroid = Vec3::Zero();
    double extent = 0;
};
WeightPlace place_of(const Eigen::VectorXd& weight, const Points& points);

}  // namespace palpate::identify
