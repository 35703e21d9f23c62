#include "pipeline/case/settings/settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/diagnosis/diagnosis.h"
#include "mesh/errors.h"
#include "pipeline/case/population_prior.h"
#include "pipeline/case/settings/declare.h"

namespace palpate::pipeline {
namespace {

using mesh::YamlFields;
using nlohmann::json;

constexpr double no_unit_is_so_large = 1e9;  // of any length [mm] or modulus [MPa]

constexpr Names<double, 3> units{{{"mm", 1}, {"cm", 10}, {"m", 1000}}};

CaseSetting expectation_of_verdict() {
    CaseSetting setting = declare::declared("expect.verdict", "verdict of the diagnosis");
    setting.schema = {{"enum", identify::verdict_names}};
    setting.read = [](const YamlFields& yaml, Case& c) {
        c.expect.verdict = yaml.choice("verdict", {identify::verdict_names.begin(), identify::verdict_names.end()});
    };
    setting.value = [](const Case& c) { return c.expect.verdict ? json(*c.expect.verdict) : json(); };
    return setting;
}

/// Read when it is named; a path in a file counts from where the file is.
CaseSetting prior_of_population() {
    CaseSetting setting =
        declare::declared("identify.prior", "folder of `palpate pool`: its specimens tell what to expect");
    setting.schema = {{"type", "string"}};
    setting.read = [](const YamlFields& yaml, Case& c) {
        c.prior = std::filesystem::absolute(yaml.file().parent_path() / yaml.text("prior")).lexically_normal();
        c.identify.priors = read_population_prior(*c.prior);
    };
    setting.value = [](const Case& c) { return c.prior ? json(c.prior->string()) : json(); };
    return setting;
}

void add_body(std::vector<CaseSetting>& all) {
    using namespace declare;
    const auto body = [&](const char* stage, CaseSetting setting) {
        all.push_back(of_stage(stage, with_flag("Body", std::move(setting))));
    };
    body("mesh", choice(
                     "unit", "unit of the mesh", units, [](auto& c) -> auto& { return c.unit; }));
    body("mesh", number(
                     "longest", "scale the mesh to this longest side [mm]; 0: as it is", {0, no_unit_is_so_large},
                     [](auto& c) -> auto& { return c.longest; }));
    body("mesh",
         number(
             "label", "the body's label in a label image", {-1e9, 1e9}, [](auto& c) -> auto& { return c.label; }));
    body("mesh", choice(
                     "keep",
                     "separate pieces of the surface; automatic: one piece and tiny fragments, which are dropped; the "
                     "largest; or all",
                     kept_pieces, [](auto& c) -> auto& { return c.keep; }));
    // What the set says counts beside these: stages depend on what comes of both.
    body("", number(
                 "material.young", "Young's modulus [MPa]", {1e-9, no_unit_is_so_large},
                 [](auto& c) -> auto& { return c.young; }));
    body("", number(
                 "material.poisson", "Poisson's ratio; towards 0.5 a body keeps its volume", {-0.99, 0.4999},
                 [](auto& c) -> auto& { return c.poisson; }));
    body("", number(
                 "material.density", "density [kg/m^3]", {0, 1e6}, [](auto& c) -> auto& { return c.density; }));
    body("mesh",
         number(
             "volume.edge_length", "edge of the tetrahedra [mm]; 0: 6 to 7 % of the longest side, less in a thin body",
             {0, no_unit_is_so_large}, [](auto& c) -> auto& { return c.edge_length; }));
    body("mesh", yes_or_no(
                     "volume.linear_elements", "tetrahedra of four nodes in place of ten, several times less accurate",
                     [](auto& c) -> auto& { return c.linear_elements; }));
    // Answers agree to far more digits than anything that depends on them.
    body("", choice(
                 "volume.solver",
                 "what solves the equations of the body that is probed; automatic: a factor where it fits into memory "
                 "and is worth it, else conjugate gradients with multigrid, or under mpirun with PETSc",
                 solvers, [](auto& c) -> auto& { return c.solver; }));
}

void add_skeleton(std::vector<CaseSetting>& all) {
    using namespace declare;
    const auto skeleton = [&](CaseSetting setting) { all.push_back(with_flag("Skeleton", std::move(setting))); };
    skeleton(number(
        "skeleton.spheres", "number of free spheres; 0: by the body's shape", {0, skeleton::BuildOptions::most_spheres},
        [](auto& c) -> auto& { return c.skeleton.spheres; }));
    skeleton(number(
        "skeleton.coverage", "largest distance of the surface from the spheres [mm]; 0: 5 % of the longest side",
        {0, no_unit_is_so_large}, [](auto& c) -> auto& { return c.skeleton.coverage; }));
    skeleton(choice(
        "skeleton.links", "stiffnesses of a link: all, or the paper's elongation, flexion and torsion", link_kinds,
        [](auto& c) -> auto& { return c.skeleton.links; }));
    skeleton(number(
        "skeleton.zones", "number of zones of equal stiffness, from the support outwards",
        {1, skeleton::BuildOptions::most_zones}, [](auto& c) -> auto& { return c.skeleton.zones; }));
    // Of a run alone: `palpate skeleton` takes the others.
    all.push_back(with_flag(
        "Sphere curve",
        of_stage("sphere_curve", yes_or_no(
                                     "skeleton.sphere_curve",
                                     "measure what fewer and more spheres would do: takes several times as long",
                                     [](auto& c) -> auto& { return c.sphere_curve; }))));
}

void add_probing(std::vector<CaseSetting>& all) {
    using namespace declare;
    const auto probing = [&](CaseSetting setting) {
        all.push_back(with_flag("Probing", of_stage("measurements", std::move(setting))));
    };
    probing(number(
        "probing.probes", "number of places that are touched", {1, ProbeOptions::most_probes},
        [](auto& c) -> auto& { return c.probing.probes; }));
    all.push_back(
        of_stage("identify", number(
                                 "probing.held_out", "number of probes that are held out of the fit, to judge it",
                                 {0, ProbeOptions::most_probes}, [](auto& c) -> auto& { return c.probing.held_out; })));
    probing(number(
        "probing.markers", "number of surface points that are read",
        {ProbeOptions::least_markers, ProbeOptions::most_markers}, [](auto& c) -> auto& { return c.probing.markers; }));
    probing(number(
        "probing.displacement", "largest displacement, over the longest side; 0: 0.005 in small strain, 0.05 in large",
        {0, ProbeOptions::most_share}, [](auto& c) -> auto& { return c.probing.displacement; }));
    all.push_back(of_stage("measurements",
                           number(
                               "probing.radius", "radius of a contact, over the longest side",
                               {1e-9, ProbeOptions::most_share}, [](auto& c) -> auto& { return c.probing.radius; })));
    probing(number(
        "probing.noise", "standard deviation of the readings [mm]", {0, no_unit_is_so_large},
        [](auto& c) -> auto& { return c.probing.noise; }));
}

void add_identification(std::vector<CaseSetting>& all) {
    using namespace declare;
    const auto identification = [&](CaseSetting setting) {
        all.push_back(with_flag("Identification", std::move(setting)));
    };
    identification(choice(
        "identify.parameters", "what shares a stiffness: all links, those of a zone, or none", scopes,
        [](auto& c) -> auto& { return c.identify.scope; }));
    identification(choice(
        "identify.method", "particle filter: tempered from the fit, or Algorithm 1 of the paper", methods,
        [](auto& c) -> auto& { return c.identify.method; }));
    identification(choice(
        "identify.domain", "what is fitted: positions of markers (tempered's default) or net forces (burion2008's)",
        domains, [](auto& c) -> auto& { return c.identify.domain; }));
    identification(choice(
        "identify.law", "law of equilibrium; automatic: the one that fits", law_choices,
        [](auto& c) -> auto& { return c.identify.law; }));
    identification(choices(
        "identify.fixed", "a kind of stiffness that stays as the model has it", stiffnesses,
        [](auto& c) -> auto& { return c.identify.fixed; }));
    identification(number(
        "identify.particles", "number of particles; 0: 200 (tempered), 600 (burion2008)", {0, 1e7},
        [](auto& c) -> auto& { return c.identify.particles; }));
    all.push_back(number(
        "identify.iterations", "number of iterations of burion2008", {1, 100000},
        [](auto& c) -> auto& { return c.identify.iterations; }));
    identification(number(
        "identify.search_low", "lower end of burion2008's search box, over the start stiffness", {1e-9, 1e9},
        [](auto& c) -> auto& { return c.identify.search_low; }));
    identification(number(
        "identify.search_high", "upper end of burion2008's search box, over the start stiffness", {1e-9, 1e9},
        [](auto& c) -> auto& { return c.identify.search_high; }));
    identification(prior_of_population());
    // A measurement's noise is drawn by it, too.
    all.push_back(of_stage("", number(
                                   "seed", "the same inputs and seed give the same numbers", {0, 2e9},
                                   [](auto& c) -> auto& { return c.identify.seed; })));
}

void add_diagnosis(std::vector<CaseSetting>& all) {
    using namespace declare;
    CaseSetting reference = yes_or_no(
        "diagnose.reference", "diagnose, on the finite-element model: minutes",
        [](auto& c) -> auto& { return c.diagnose.reference; });
    reference.flag = "--no-reference";
    reference.flag_value = "false";
    reference.flag_help = "skip the diagnosis: fast";
    reference.group = "Diagnosis";
    all.push_back(reference);
    all.push_back(texts(
        "diagnose.without", "effects that are left out of the catalogue (`palpate effects` lists them)",
        [](auto& c) -> auto& { return c.diagnose.without; }));
    all.push_back(with_flag(
        "Diagnosis", choice(
                         "diagnose.gravity",
                         "what is known of gravity; automatic: the earth's magnitude is tried beside a free one where "
                         "the density is given",
                         gravities, [](auto& c) -> auto& { return c.diagnose.gravity; })));
    all.push_back(with_flag(
        "Diagnosis", number(
                         "diagnose.false_claims", "largest probability of naming an effect where none is missing",
                         {1e-12, 0.1}, [](auto& c) -> auto& { return c.diagnose.false_claims; })));
}

void add_expectations(std::vector<CaseSetting>& all) {
    using namespace declare;
    const auto expect = [&](CaseSetting setting) { all.push_back(of_stage("", std::move(setting))); };
    expect(number(
        "expect.relative_at_most", "largest rms error over rms displacement", {0, 1e9},
        [](auto& c) -> auto& { return c.expect.relative_at_most; }));
    expect(number(
        "expect.held_out_at_most", "the same on held-out probes", {0, 1e9},
        [](auto& c) -> auto& { return c.expect.held_out_at_most; }));
    expect(number(
        "expect.modes", "number of modes of the posterior, of 5 % and more each", {1, 100},
        [](auto& c) -> auto& { return c.expect.modes; }));
    expect(number(
        "expect.spheres_at_least", "least number of spheres", {1, 1e6},
        [](auto& c) -> auto& { return c.expect.spheres_at_least; }));
    expect(expectation_of_verdict());
    expect(texts(
        "expect.explanation", "effects that the diagnosis names, in any order",
        [](auto& c) -> auto& { return c.expect.explanation; }));
    expect(number(
        "expect.rms_at_most_mm", "largest rms error of the skeleton once these effects are in it [mm]", {0, 1e9},
        [](auto& c) -> auto& { return c.expect.rms_at_most_mm; }));
}

}  // namespace

const std::vector<CaseSetting>& settings() {
    static const std::vector<CaseSetting> all = [] {
        std::vector<CaseSetting> list;
        for (const auto& add :
             {add_body, add_skeleton, add_probing, add_identification, add_diagnosis, add_expectations})
            add(list);
        return list;
    }();
    return all;
}

const CaseSetting& setting_at(std::string_view place) {
    const auto found = std::ranges::find(settings(), place, &CaseSetting::place);
    if (found == settings().end()) throw std::logic_error(fmt::format("there is no setting {}", place));
    return *found;
}

json settings_of_stage(const Case& c, std::string_view stage) {
    json key = json::object();
    for (const CaseSetting& setting : settings())
        if (setting.stage == stage) key[setting.place()] = setting.value(c);
    return key;
}

}  // namespace palpate::pipeline
