#include "pipeline/verbs/flags.h"

namespace palpate::pipeline {

void add_body_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--unit", say.unit, "Unit of the mesh")->check(CLI::IsMember({"mm", "cm", "m"}))->group("Body");
    verb->add_option("--longest", say.longest, "Scale the mesh to this longest side [mm]")
        ->check(CLI::PositiveNumber)
        ->group("Body");
    verb->add_option("--label", say.label, "Of a label image: which label is the body")->group("Body");
    verb->add_option("--young", say.young, "Young's modulus [MPa]")->check(CLI::PositiveNumber)->group("Body");
    verb->add_option("--poisson", say.poisson, "Poisson's ratio")->check(CLI::Range(-0.99, 0.4999))->group("Body");
    verb->add_option("--density", say.density, "Density [kg/m^3]")->check(CLI::NonNegativeNumber)->group("Body");
    add_edge_length(verb, say);
    verb->add_flag("--linear-elements", say.linear_elements, "Four-node tetrahedra in place of quadratic ones")
        ->group("Body");
}

void add_skeleton_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--spheres", say.spheres, "Number of free spheres; by the body's shape by default")
        ->check(CLI::Range(1, 100000))
        ->group("Skeleton");
    verb->add_option("--coverage", say.coverage, "No surface further outside the spheres than this [mm]")
        ->check(CLI::PositiveNumber)
        ->group("Skeleton");
    verb->add_option("--links", say.links, "full, or burion2008: the paper's elongation, flexion and torsion alone")
        ->check(CLI::IsMember({"full", "burion2008"}))
        ->group("Skeleton");
    verb->add_option("--zones", say.zones, "Zones of equal stiffness, from the support outwards")
        ->check(CLI::Range(1, 1000))
        ->group("Skeleton");
}

void add_identify_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--parameters", say.parameters, "What is identified: uniform, zones, links")
        ->check(CLI::IsMember({"uniform", "zones", "links"}))
        ->group("Identification");
    verb->add_option("--method", say.method, "tempered: particles tempered from the fit; burion2008: Algorithm 1")
        ->check(CLI::IsMember({"tempered", "burion2008"}))
        ->group("Identification");
    verb->add_option("--domain", say.domain,
                     "What measurements are weighed by: position (markers; the default of tempered) or force\n"
                     "(net forces in the measured configurations; the default of burion2008)")
        ->check(CLI::IsMember({"position", "force"}))
        ->group("Identification");
    verb->add_option("--particles", say.particles, "Number of particles")
        ->check(CLI::Range(2, 10'000'000))
        ->group("Identification");
}

void add_probing_flags(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--probes", say.probes, "Number of places that are touched")
        ->check(CLI::Range(1, 10000))
        ->group("Probing");
    verb->add_option("--noise", say.noise, "1 sigma of the readings [mm]")
        ->check(CLI::NonNegativeNumber)
        ->group("Probing");
}

void add_body(CLI::App* verb, std::string& body, const std::string& when) {
    verb->add_option("--body", body,
                     "What the errors are judged on: reference (finite elements, " + when +
                         ")\nor skeleton, whose coarseness may be taken for physics")
        ->check(CLI::IsMember({"reference", "skeleton"}));
}

void add_edge_length(CLI::App* verb, CaseOverrides& say) {
    verb->add_option("--edge-length", say.edge_length,
                     "Of the tetrahedra [mm]; 6 % of the longest side by default, less in a thin body; 7 % where "
                     "effects are looked for")
        ->check(CLI::PositiveNumber)
        ->group("Body");
}

}  // namespace palpate::pipeline
