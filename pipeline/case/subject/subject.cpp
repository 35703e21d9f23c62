#include "pipeline/case/subject/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "identify/measurements/field.h"
#include "identify/measurements/files/rig/regions_yaml.h"
#include "identify/measurements/labels/label_readings.h"
#include "identify/measurements/plausibility.h"
#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/numbers/median.h"
#include "mesh/regions/labels.h"
#include "mesh/supports/support_points.h"
#include "pipeline/body/body.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/body_verdict.h"
#include "pipeline/case/subject/weight.h"

namespace palpate::pipeline {
namespace {

/// Up to three vertices that lie more than a hundred times as far off as all others, in words; empty: there are none.
/// The others then span less than 2 % of the length, which is less than one element of a mesh that is sized by it: a
/// body would be of one element there, so the few are a slip.
std::string stray_vertices(const mesh::Surface& surface) {
    constexpr double far = 100;
    constexpr Eigen::Index most = 3, least_others = 4;  // others: fewer enclose nothing
    const Points& vertices = surface.vertices;
    const Eigen::Index count = vertices.rows();
    if (count <= least_others) return {};
    // Medians: few strays do not move them.
    Vec3 middle;
    for (int c = 0; c < 3; ++c)
        middle[c] = mesh::upper_median(std::vector(vertices.col(c).begin(), vertices.col(c).end()));
    const Eigen::VectorXd distance = (vertices.rowwise() - middle.transpose()).rowwise().norm();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](Eigen::Index v) { return distance[v]; });
    for (Eigen::Index strays = 1; strays <= std::min(most, count - least_others); ++strays) {
        const auto first = order.end() - strays;
        if (distance[*first] <= far * distance[*(first - 1)]) continue;
        const std::vector<Eigen::Index> others(order.begin(), first);
        const Vec3 size = mesh::bounding_box(vertices(others, Eigen::all)).extent();
        const Vec3 at = vertices.row(*first);
        const bool is_one = strays == 1;
        return fmt::format(
            "{} at ({:.4g}, {:.4g}, {:.4g}) mm{} far from the other {}, which span {:.4g} x {:.4g} x {:.4g} mm: remove "
            "or correct {}",
            is_one ? "One vertex" : fmt::format("{} vertices, the nearest", strays), at.x(), at.y(), at.z(),
            is_one ? " lies" : ", lie", others.size(), size.x(), size.y(), size.z(), is_one ? "it" : "them");
    }
    return {};
}

/// Leaves out what is not the body, and notes what it cannot be.
void judge_body(Subject& subject, const std::string& name) {
    if (!subject.volume) {
        KeptSurface kept = keep_pieces(subject.surface, subject.settings.keep);
        subject.surface = std::move(kept.surface);
        std::ranges::move(kept.notes, std::back_inserter(subject.notes));
        subject.refusal = refusal_of_flat(subject.surface);
        if (std::string strays = stray_vertices(subject.surface); !strays.empty()) {
            if (subject.refusal.empty())
                subject.notes.push_back(strays + ".");
            else
                subject.refusal = std::move(strays);
        }
        if (subject.refusal.empty()) subject.refusal = std::move(kept.refusal);
        if (!subject.refusal.empty()) subject.refusal = name + ": " + subject.refusal;
    }
}

void read_mesh(Subject& subject) {
    const Case& c = subject.settings;
    mesh::BodyFile read = mesh::read_body(*c.mesh, {.label = c.label, .parts = mesh::labels_of(c.regions)});
    subject.files = read.files;
    subject.surface = std::move(read.surface);
    subject.volume = std::move(read.volume);
    subject.notes = std::move(read.notes);
    const double longest = mesh::bounding_box(subject.surface.vertices).longest_side();
    if (longest <= 0) {
        throw InvalidInput(
            fmt::format("{}: all its vertices are at one place; a body needs an extent", c.mesh->string()));
    }
    if (read.is_in_mm && c.unit != 1) {
        throw InvalidInput(fmt::format(
            "{}: states its unit itself, and has been converted to mm; leave --unit out ('--longest' scales it)",
            c.mesh->string()));
    }
    const double scale = c.longest > 0 ? c.longest / longest : c.unit;
    subject.surface.vertices *= scale;
    if (subject.volume) subject.volume->nodes *= scale;
    subject.regions = c.regions;
    for (mesh::MaterialRegion& region : subject.regions) {
        region.surface.vertices *= scale;
        if (!region.label) subject.files.push_back(region.file);
    }
    mesh::take_parts(read.parts, scale, subject.regions);
    judge_body(subject, c.mesh->string());
    std::string strange = identify::implausible_size(mesh::bounding_box(subject.surface.vertices).longest_side());
    if (!strange.empty()) subject.notes.push_back(std::move(strange));
    if (c.longest == 0 && c.unit == 1 && !read.is_in_mm) {
        subject.assumptions.push_back(
            fmt::format("The mesh is taken to be in mm: {:.4g} mm at its longest (--unit or --longest changes this).",
                        mesh::bounding_box(subject.surface.vertices).longest_side()));
    }
}

void read_set(Subject& subject) {
    const Case& c = subject.settings;
    subject.set = read_measurements(*c.measurements, subject.notes, c.edge_length);
    subject.surface = subject.set->rest_surface;
    subject.volume = subject.set->rest_volume;
    subject.regions = subject.set->regions;
    judge_body(subject, "the rest surface of " + subject.set->folder.string());
    subject.set->rest_surface = subject.surface;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(subject.set->folder)) {
        if (entry.is_regular_file() && entry.path().filename() != "truth.json") subject.files.push_back(entry.path());
    }
    std::sort(subject.files.begin(), subject.files.end());
}

/// Supports, or what is gripped, given by points as the patches that these sample; what was made of them stands in
/// `notes`.
std::vector<mesh::Region> patched(const std::vector<mesh::Region>& supports, const mesh::Surface& surface,
                                  double edge_length, std::vector<std::string>& notes,
                                  const std::string& name = "Support") {
    mesh::PatchedSupports result = mesh::patched(supports, surface, edge_length, name);
    std::ranges::move(result.notes, std::back_inserter(notes));
    std::ranges::move(result.warnings, std::back_inserter(notes));
    return std::move(result.regions);
}

void choose_supports(Subject& subject) {
    if (!subject.settings.supports.empty()) {
        const double specified = subject.settings.edge_length;
        const double edge = specified > 0 ? specified
                            : subject.set ? reference_edge_length(subject.surface)
                                          : default_edge_length(subject.surface);
        subject.supports = patched(subject.settings.supports, subject.surface, edge, subject.notes);
    } else if (subject.set) {
        subject.supports = subject.set->supports;
    } else {
        const mesh::BoxRegion clamp = default_clamp(mesh::bounding_box(subject.surface.vertices));
        subject.supports = {clamp};
        subject.assumptions.push_back(
            fmt::format("Held over the 5 % of its length at the low end of its longest axis, in the box ({:.4g}, "
                        "{:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm ('supports' in a case changes this).",
                        clamp.min.x(), clamp.min.y(), clamp.min.z(), clamp.max.x(), clamp.max.y(), clamp.max.z()));
    }
    if (subject.set) subject.set->supports = subject.supports;
}

/// What the case says, else the set, else a default, which is said aloud.
double choose(const std::optional<double>& said, double measured, double fallback, const std::string& name,
              const std::string& unit, const std::string& flag, std::vector<std::string>& assumptions) {
    if (said) return *said;
    if (std::isfinite(measured)) return measured;
    assumptions.push_back(fmt::format("{} is taken to be {:g}{} (set {} to change it).", name, fallback, unit, flag));
    return fallback;
}

void choose_material(Subject& subject) {
    const Case& c = subject.settings;
    const auto guess = subject.set && subject.set->material ? *subject.set->material : identify::MaterialGuess{};
    const double density =
        subject.set && subject.set->density ? *subject.set->density / fem::tonne_per_mm3 : identify::missing;
    // A fit only starts from what is assumed here; a reference simulation takes it for true.
    const std::string start = subject.set ? " to start from" : "";
    subject.material.young =
        choose(c.young, guess.young, 0.1, "Young's modulus" + start, " MPa", "--young", subject.assumptions);
    subject.material.poisson =
        choose(c.poisson, guess.poisson, 0.45, "Poisson's ratio" + start, "", "--poisson", subject.assumptions);
    subject.material.density = fem::tonne_per_mm3 * choose(c.density, density, 1000, "The density", " kg/m^3",
                                                           "--density", subject.assumptions);
    subject.material.validate();
}

/// A simulation has to know what it is of.
void check_regions_of_case(const Subject& subject) {
    const std::string where = subject.settings.file.empty() ? "--region" : subject.settings.file.string();
    for (const mesh::MaterialRegion& region : subject.regions)
        if (!region.young)
            throw InvalidInput(
                fmt::format("{}: region '{}' has no 'young', which a simulation needs: give it in MPa. Only a "
                            "measurement set may leave it to be identified (young: null).",
                            where, region.name));
    identify::check_material_regions(subject.regions, subject.surface, subject.supports, where);
}

}  // namespace

identify::MeasurementSet read_measurements(const std::filesystem::path& path, std::vector<std::string>& notes,
                                           double edge_length) {
    identify::MeasurementSet read = identify::read_measurement_set(path);
    identify::take_displacements_from_rest(read);
    identify::take_correlated_noise(read);
    std::ranges::move(read.notes, std::back_inserter(notes));
    read.notes.clear();
    identify::LabelledSet labelled = identify::label_readings(identify::with_markers_of_fields(read));
    std::ranges::transform(identify::notes(labelled), std::back_inserter(notes),
                           [](const std::string& words) { return words + "."; });
    std::ranges::copy(identify::implausible(labelled.set), std::back_inserter(notes));
    const mesh::Surface& surface = labelled.set.rest_surface;
    const double edge = edge_length > 0 ? edge_length : reference_edge_length(surface);
    labelled.set.supports = patched(labelled.set.supports, surface, edge, notes);
    for (mesh::Tool& tool : labelled.set.tools)
        if (auto* grip = std::get_if<mesh::GripShape>(&tool.shape))
            grip->regions = patched(grip->regions, surface, edge, notes, fmt::format("Tool '{}', region", tool.name));
    for (identify::LoadState& state : labelled.set.states) {
        std::erase_if(state.readings, [](const identify::Reading& reading) { return reading.marker < 0; });
    }
    take_weight_as_load(labelled.set, notes);
    return std::move(labelled.set);
}

Subject read_subject(Case settings) {
    Subject subject = read_subject_as_it_is(std::move(settings));
    if (!subject.refusal.empty()) throw InvalidInput(subject.refusal);
    return subject;
}

Subject read_subject_as_it_is(Case settings) {
    Subject subject;
    subject.settings = std::move(settings);
    if (subject.settings.mesh) {
        read_mesh(subject);
    } else {
        read_set(subject);
    }
    choose_supports(subject);
    if (subject.settings.mesh) check_regions_of_case(subject);
    if (!subject.settings.model) choose_material(subject);
    return subject;
}

}  // namespace palpate::pipeline
