#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/models/reference/reference_body.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/numerics/random.h"
#include "mesh/core/volume_mesh.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::identify {

/// A bar of 40 x 10 x 10 mm, held at the face x = 0, as both models see it, with markers and probes: small enough that
/// a fit takes a fraction of a second. E = 0.3 MPa, nu = 0.45: its end yields by some 80 mm/N.
struct SmallBody {
    mesh::VolumeMesh mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {5, 1, 1}));
    std::vector<mesh::Region> supports{mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(0.1, 11, 11)}};
    std::vector<Marker> markers = on_surface();

    static constexpr double young = 0.3;  // [MPa]

    /// Four rows along the bar and four markers on its end.
    static std::vector<Marker> on_surface() {
        std::vector<Vec3> at;
        for (const double x : {6.0, 14.0, 22.0, 30.0, 37.0}) {
            for (const auto& [y, z] : {std::pair{0, 4}, {6, 0}, {10, 6}, {4, 10}}) at.emplace_back(x, y, z);
        }
        for (const auto& [y, z] : {std::pair{2, 2}, {8, 3}, {3, 8}, {7, 7}}) at.emplace_back(40, y, z);
        std::vector<Marker> markers;
        markers.reserve(at.size());
        for (const Vec3& x : at) markers.push_back({static_cast<int>(markers.size()), x, {}});
        return markers;
    }
    /// Besides, two that stand 6 mm off: on the end and on the side.
    static std::vector<Marker> with_pins() {
        std::vector<Marker> markers = on_surface();
        markers.push_back({24, Vec3(46, 5, 5), Vec3(40, 5, 5)});
        markers.push_back({25, Vec3(19, 16, 5), Vec3(19, 10, 5)});
        return markers;
    }

    /// The bar with a hollow within, of 13 x 3.3 x 3.3 mm.
    static SmallBody hollow() {
        const mesh::VolumeMesh solid = mesh::make_bar(Vec3::Zero(), Vec3(40, 10, 10), {3, 3, 3});
        const mesh::BoxRegion inside{Vec3(40, 10, 10) / 3, Vec3(80, 20, 20) / 3};
        std::vector<int> walls;
        for (int e = 0; e < static_cast<int>(solid.tetrahedra.rows()); ++e) {
            const Eigen::RowVector4i corners = solid.tetrahedra.row(e);
            const Points centre = solid.nodes(corners, Eigen::all).colwise().mean();
            if (mesh::contains({inside}, centre)[0] == 0) walls.push_back(e);
        }
        mesh::VolumeMesh mesh{.nodes = solid.nodes, .tetrahedra = solid.tetrahedra(walls, Eigen::all), .faces = {}};
        mesh.faces = mesh::boundary_faces(mesh.tetrahedra);
        SmallBody body;
        body.mesh = mesh::to_quadratic(mesh);
        return body;
    }

    /// For twins, whose readings are those of this very mesh.
    std::unique_ptr<ReferenceBody> reference() const {
        return std::make_unique<ReferenceBody>(mesh, supports, markers,
                                               ReferenceBodyOptions{.young = 0.1, .measured_on_mesh = true});
    }

    /// Five spheres along the axis; stiffnesses of the section: EA/L, 2 EI/L at both ends, GJ/L.
    skeleton::Model chain() const {
        skeleton::Model model;
        model.name = "bar";
        model.surface = mesh::boundary_surface(mesh);
        model.supports = supports;
        for (int i = 0; i < 5; ++i) {
            skeleton::Sphere sphere;
            sphere.center = Vec3(10.0 * i, 5, 5);
            sphere.radius = 5;
            sphere.mass = i == 0 || i == 4 ? 5e-7 : 1e-6;
            sphere.inertia = 17 * sphere.mass * Mat3::Identity();
            sphere.held = i == 0;
            model.spheres.push_back(sphere);
            if (i > 0) model.links.push_back({i - 1, i, 10, Vec3(3, 50, 15), 0, 0, {}});
        }
        for (const auto& vertex : model.surface.vertices.rowwise())
            model.skin.push_back(skeleton::attach_to_links(model, vertex));
        return model;
    }
    std::unique_ptr<SkeletonBody> skeleton() const { return std::make_unique<SkeletonBody>(chain(), markers, young); }

    /// The unloaded state, then pushes and pulls on all sides along the bar, `count` of them; beyond 8 the same places
    /// again, the other way and weaker.
    static std::vector<LoadState> probes(double force = 0.03, int count = 8) {
        const std::vector<mesh::Contact> all{
            {Vec3(36, 5, 10), Vec3(0, 0.1, -1), 3},    {Vec3(20, 5, 10), Vec3(0, 0, -2), 3},
            {Vec3(34, 0, 5), Vec3(0.2, 1, 0), 3},      {Vec3(24, 10, 5), Vec3(0, -1.5, 0.2), 3},
            {Vec3(40, 5, 5), Vec3(-3, 0.3, 0), 3},     {Vec3(30, 5, 0), Vec3(0.3, 0, 1.2), 3},
            {Vec3(37, 10, 3), Vec3(0, 0.3, 0.9), 2.5}, {Vec3(14, 0, 5), Vec3(0.5, 3, 0), 3}};
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (int i = 0; i < count; ++i) {
            LoadState state{.probe = i + 1, .time = 1, .contacts = {all[i % 8]}};
            state.contacts[0].force *= i < 8 ? force : -0.7 * force;
            states.push_back(state);
        }
        return states;
    }

    /// Pushes that are held, each read at once, after 5 s, and 5 s after it was taken off again.
    static std::vector<LoadState> dwells(double force = 0.03, int count = 4) {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (LoadState state : probes(force, count)) {
            if (state.contacts.empty()) continue;
            for (const double time : {0.2, 5.0}) {
                state.time = time;
                states.push_back(state);
            }
            states.push_back({.probe = state.probe, .time = 10});
        }
        return states;
    }

    /// Pushes, each read under its load and after it was taken off again.
    static std::vector<LoadState> releases(double force = 0.1, int count = 4) {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (const LoadState& state : probes(force, count)) {
            if (state.contacts.empty()) continue;
            states.push_back(state);
            states.push_back({.probe = state.probe, .time = state.time + 1});
        }
        return states;
    }

    /// Pushes, each to half of it, all of it, back to half and taken off.
    static std::vector<LoadState> returns(double force = 0.1, int count = 4) {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (LoadState state : probes(force, count)) {
            if (state.contacts.empty()) continue;
            const Vec3 whole = state.contacts.front().force;
            for (const double share : {0.5, 1.0, 0.5}) {
                state.contacts.front().force = share * whole;
                states.push_back(state);
                state.time += 1;
            }
            states.push_back({.probe = state.probe, .time = state.time});
        }
        return states;
    }

    /// Pushes, each put on in two steps and taken off again, read right after each change and some time later.
    static std::vector<LoadState> steps(double force = 0.1, int count = 4) {
        std::vector<LoadState> states{LoadState{.probe = 0}};
        for (LoadState state : probes(force, count)) {
            if (state.contacts.empty()) continue;
            const Vec3 whole = state.contacts.front().force;
            for (const auto& [time, share] :
                 {std::pair{1.0, 0.5}, {5.0, 0.5}, {6.0, 1.0}, {10.0, 1.0}, {11.0, 0.0}, {15.0, 0.0}}) {
                state.time = time;
                state.contacts.front().force = share * whole;
                states.push_back(state);
            }
        }
        return states;
    }

    /// States with a reading of every marker, each at rest.
    MeasurementSet set(std::vector<LoadState> states) const {
        MeasurementSet set;
        set.name = "bar";
        set.rest_surface = mesh::boundary_surface(mesh);
        set.supports = supports;
        set.markers = markers;
        set.states = std::move(states);
        for (LoadState& state : set.states) {
            for (int m = 0; m < static_cast<int>(markers.size()); ++m) state.readings.push_back({m, markers[m].rest});
        }
        return set;
    }
};

/// The bar's stiffness: E = 0.3 MPa, nu = 0.45 for the reference body; the chain's own for the skeleton.
inline Explanation bare_truth(const BodyModel& model, int law) {
    Explanation truth;
    truth.law = law;
    truth.theta = Eigen::VectorXd::Zero(std::ssize(model.parameters()));
    if (truth.theta.size() == 2) truth.theta << std::log(SmallBody::young), std::log(0.1);
    return truth;
}

inline Explanation with(Explanation truth, std::shared_ptr<const EffectHypothesis> effect,
                        const Eigen::VectorXd& values) {
    truth.effects.push_back(std::move(effect));
    truth.values.push_back(values);
    return truth;
}

/// Numbers of an effect that bends or moves the bar by some tenths of a millimetre and more.
inline Eigen::VectorXd example(const EffectHypothesis& effect, const std::vector<EffectNumber>& numbers) {
    static const std::map<std::string, std::vector<double>> chosen{
        {"stiffening", {std::asinh(1 / 1.4), std::log(10)}},
        {"anisotropy", {1.5, 0.48, 0.6, 0.64}},  // of unit length, as they are told
        {"inclusion", {21, 6, 4, std::log(7), std::log(3)}},
        {"volume", {std::log(0.1), std::log(0.4)}},
        {"contact", {0, 0.28, 0.96, -0.3, std::log(0.02)}},
        {"pressure", {0.01}},
        {"prestress", {0.01, -0.006, 0.004, 0.006, -0.004, 0.002}},
        {"viscosity", {0.5, std::log(3)}},
        {"plasticity", {std::log(0.02), std::log(0.3)}},
        {"damage", {0.9, std::log(0.05)}},
        {"friction", {0.3}},
        {"local-force", {30, 6, 4, std::log(5), 0.002, -0.001, 0.003}},
        {"local-springs", {30, 6, 4, std::log(5), std::log(0.01)}},
        {"local-swelling", {21, 6, 4, std::log(5), 0.05}},
        {"torsion", {0.3}},
        {"shear", {0.3}}};
    const auto found = chosen.find(effect.name());
    Eigen::VectorXd values(std::ssize(numbers));
    if (effect.name() == "map") {  // a length, then a place and an amplitude each: soft and stiff in turn
        for (Eigen::Index j = 0; j < values.size(); ++j)
            values[j] = j == 0 || !effect.is_fitted(j) ? numbers[j].start : j % 8 == 0 ? 0.8 : -0.8;
        return values;
    }
    for (Eigen::Index j = 0; j < values.size(); ++j) {
        values[j] = found != chosen.end() ? found->second[j]
                                          : numbers[j].prior_mean + 0.2 * numbers[j].prior_sd * (j % 2 ? 1 : -0.7);
    }
    return values;
}

/// A twin: what a model shows in all states, read with noise [mm] that the set tells; of reactions what is not NaN.
inline MeasurementSet make_twin(const BodyModel& model, MeasurementSet set, const Explanation& truth, double noise,
                                std::uint64_t seed = 1) {
    const Problem merged = make_problem(set, 1), problem = truth.has_memory() ? merged.stage_by_stage() : merged;
    const ForwardSolution forward = solve_forward(model, problem, truth, 1);
    RandomStream random(seed, 0, 0);
    std::map<int, int> action;  // of each state
    for (Eigen::Index n = 0; n < problem.rows(); ++n) action[problem.state[n]] = problem.action[n];
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const Points& channels = forward.markers[action[static_cast<int>(s)]];
        for (Reading& reading : set.states[s].readings) {
            reading.position = channels.row(reading.marker).transpose() + noise * Vec3(random.normals(3));
        }
        for (ReactionReading& reading : set.states[s].reactions) {
            const Eigen::Index force = problem.markers + 2 * Eigen::Index{reading.tool};
            const double sd = set.reaction_noise.value_or(0);
            reading.force += channels.row(force).transpose() + sd * Vec3(random.normals(3));
            reading.moment += channels.row(force + 1).transpose();
        }
    }
    if (noise > 0) set.position_noise = noise;
    return set;
}

}  // namespace palpate::identify
