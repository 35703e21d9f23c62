#include "pipeline/synthesis/rig/rig_probes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "identify/measurements/rig/rig_places.h"
#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/text/words.h"
#include "pipeline/synthesis/effects/effect_spec.h"
#include "pipeline/synthesis/probing/probing.h"

namespace palpate::pipeline {
namespace {

/// "1,2,3".
Vec3 point_of(const std::string& text, const char* option) {
    std::vector<double> numbers;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const auto number = mesh::parse_number(part);
        if (!number)
            throw InvalidInput(fmt::format("{}: {} in {} is no number; write x,y,z in mm", option, mesh::cited(part),
                                           mesh::cited(text)));
        numbers.push_back(*number);
    }
    if (numbers.size() != 3)
        throw InvalidInput(
            fmt::format("{}: {} holds {} numbers; write x,y,z in mm", option, mesh::cited(text), numbers.size()));
    return {numbers[0], numbers[1], numbers[2]};
}

/// "1,2,3 4,5,6".
Points path_of(const std::string& text) {
    std::stringstream parts(text);
    std::vector<Vec3> points;
    for (std::string part; parts >> part;) points.push_back(point_of(part, "--tendon"));
    if (points.size() < 2)
        throw InvalidInput(fmt::format("--tendon: {} holds {} point; a path has two or more, x,y,z x,y,z, in mm",
                                       mesh::cited(text), points.size()));
    Points path(std::ssize(points), 3);
    for (std::size_t p = 0; p < points.size(); ++p) path.row(static_cast<Eigen::Index>(p)) = points[p].transpose();
    return path;
}

struct ToolSpec {
    bool is_flat = false;
    double radius = 0;  // [mm]
};

ToolSpec tool_of(const std::string& text) {
    const char* const expected = "write sphere:radius=5 or flat:radius=4, in mm";
    if (!objection_to_spec(text).empty())
        throw InvalidInput(fmt::format("--tool: {}; {}", mesh::cited(text), expected));
    const EffectSpec spec = read_specs({text}).front();
    const bool is_flat = spec.effect == "flat";
    if (!is_flat && spec.effect != "sphere")
        throw InvalidInput(fmt::format("--tool: {} is no shape; {}", mesh::cited(spec.effect), expected));
    if (spec.given.size() != 1 || spec.given.front().name != "radius" || !(spec.given.front().value > 0))
        throw InvalidInput(
            fmt::format("--tool: {} does not tell a radius above 0 alone; {}", mesh::cited(text), expected));
    return {is_flat, spec.given.front().value};
}

struct Place {
    Vec3 point, normal;  // on the surface, outward
};

/// Where the tool touches the surface at one place alone, of those that are spread over it.
std::vector<Place> places_for(const ToolSpec& tool, const mesh::Surface& surface,
                              const std::vector<mesh::Region>& supports, const ProbeOptions& probing,
                              std::uint64_t seed) {
    constexpr int candidates = 6;       // for each place: some do not do
    constexpr double square = 0.985;    // cosine: within 10 degrees of a flat punch's axis
    constexpr double smooth = 0.94;     // cosine: no edge within half a radius, which would be pressed at a point
    constexpr double touching = 0.995;  // of the radius: nothing is nearer to a ball's centre but by rounding
    ProbeOptions many = probing;
    many.probes = std::min(candidates * probing.probes, ProbeOptions::most_probes);
    // As far from supports as it is wide, or it would press what holds the body.
    many.radius = std::max(many.radius, tool.radius / mesh::bounding_box(surface.vertices).longest_side());
    const mesh::SurfaceTree tree(surface);
    std::vector<Place> places;
    for (const mesh::Contact& contact : probing_contacts(surface, supports, many, seed)) {
        if (std::ssize(places) == probing.probes) break;
        const mesh::SurfacePoint on = tree.closest(contact.point);
        const Place place{on.position, mesh::mean_normal(surface, on.position, 0)};
        if (place.normal.dot(mesh::mean_normal(surface, on.position, 0.5 * tool.radius)) < smooth) continue;
        if (tool.is_flat) {
            if (!places.empty() && place.normal.dot(places.front().normal) < square) continue;
        } else if (tree.closest(place.point + tool.radius * place.normal).distance < touching * tool.radius) {
            continue;  // it would lie in a hollow that is narrower than itself
        }
        places.push_back(place);
    }
    if (places.empty())
        throw InvalidInput(
            fmt::format("--tool: no place of the free surface can be touched by a radius of {:g} mm; make it smaller",
                        tool.radius));
    return places;
}

void add_tool(const mesh::Surface& surface, const std::vector<mesh::Region>& supports, const RigOptions& options,
              const ProbeOptions& probing, std::uint64_t seed, RigProbes& result) {
    const ToolSpec spec = tool_of(options.tool);
    const std::vector<Place> places = places_for(spec, surface, supports, probing, seed);
    if (std::ssize(places) < probing.probes)
        result.notes.push_back(fmt::format("The tool finds {} places to press at, of {} that were asked for.",
                                           places.size(), probing.probes));
    // Where it stands as it just touches: a ball's centre, a punch's face.
    const auto touching = [&](const Place& place) -> Vec3 {
        return spec.is_flat ? place.point : Vec3(place.point + spec.radius * place.normal);
    };
    mesh::Tool tool{.name = "indenter", .shape = mesh::SphereShape{spec.radius}, .origin = touching(places.front())};
    const Vec3 axis = -places.front().normal;
    if (spec.is_flat) tool.shape = mesh::FlatShape{spec.radius, axis};
    for (std::size_t p = 0; p < places.size(); ++p) {
        ProbeLoadHistory history{.probe = static_cast<int>(p) + 1, .contact = {}, .rows = rows_of(options.depth, {})};
        history.drive = {.tool = static_cast<int>(result.rig.tools.size()),
                         .from = touching(places[p]) - tool.origin,
                         .along = spec.is_flat ? axis : Vec3(-places[p].normal)};
        result.histories.push_back(std::move(history));
    }
    result.rig.tools.push_back(std::move(tool));
}

void add_actuator(const std::string& name, decltype(mesh::Actuator::kind) kind, const std::vector<double>& values,
                  RigProbes& result) {
    const auto number = static_cast<int>(result.rig.actuators.size());
    result.rig.actuators.push_back({name, std::move(kind)});
    for (const double value : values) {
        ProbeLoadHistory history{
            .probe = static_cast<int>(result.histories.size()) + 1, .contact = {}, .rows = rows_of({value}, {})};
        history.drive.actuator = number;
        result.histories.push_back(std::move(history));
    }
}

}  // namespace

RigProbes rig_probes(const mesh::Surface& surface, const std::vector<mesh::Region>& supports, const RigOptions& options,
                     const ProbeOptions& probing, std::uint64_t seed) {
    RigProbes result;
    if (!options.tool.empty()) add_tool(surface, supports, options, probing, seed, result);
    if (!options.pressure.empty()) {
        std::vector<Vec3> near;
        near.reserve(options.cavity.size() + 1);
        for (const std::string& text : options.cavity) near.push_back(point_of(text, "--cavity"));
        if (near.empty())
            near.emplace_back(
                0.5 * (surface.vertices.colwise().minCoeff() + surface.vertices.colwise().maxCoeff()).transpose());
        for (std::size_t c = 0; c < near.size(); ++c)
            add_actuator(fmt::format("chamber{}", c + 1), mesh::PressureActuator{near[c]}, options.pressure, result);
    }
    const bool by_length = !options.pull.empty();
    std::optional<identify::RestBody> body;
    for (std::size_t t = 0; t < options.tendon.size(); ++t) {
        const std::string name = fmt::format("tendon{}", t + 1);
        const mesh::TendonActuator tendon{path_of(options.tendon[t]), by_length};
        if (!body) body.emplace(surface);
        identify::check_tendon(tendon, *body, name, "--tendon");
        add_actuator(name, tendon, by_length ? options.pull : options.tension, result);
    }
    return result;
}

}  // namespace palpate::pipeline
