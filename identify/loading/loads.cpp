#include "identify/loading/loads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "identify/numerics/summaries.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::identify {
namespace {

struct PatchPoint {
    Vec3 position;
    double area;  // [mm^2]
};

/// Centres of equal pieces of a triangle that lie within a contact; pieces are at most a third of its radius long.
void sample_triangle(const Vec3& p0, const Vec3& p1, const Vec3& p2, const mesh::Contact& contact,
                     std::vector<PatchPoint>& patch) {
    const double longest = std::max({(p1 - p0).norm(), (p2 - p1).norm(), (p0 - p2).norm()});
    if (((p0 + p1 + p2) / 3 - contact.point).norm() > contact.radius + longest) return;

    constexpr int most_cuts = 64;
    const int n = std::clamp(static_cast<int>(std::ceil(3 * longest / contact.radius)), 1, most_cuts);
    const double area = (p1 - p0).cross(p2 - p0).norm() / (2.0 * n * n);
    const auto add = [&](double i, double j) {  // barycentric (i, j) / n
        const Vec3 position = p0 + i / n * (p1 - p0) + j / n * (p2 - p0);
        if ((position - contact.point).norm() <= contact.radius) patch.push_back({position, area});
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n - i; ++j) {
            add(i + 1.0 / 3, j + 1.0 / 3);                     // upright piece
            if (j < n - i - 1) add(i + 2.0 / 3, j + 2.0 / 3);  // its upside-down neighbour
        }
    }
}

std::vector<PatchPoint> sample_patch(const mesh::Surface& surface, const mesh::Contact& contact) {
    std::vector<PatchPoint> patch;
    for (const auto& triangle : surface.triangles.rowwise()) {
        sample_triangle(surface.vertices.row(triangle[0]), surface.vertices.row(triangle[1]),
                        surface.vertices.row(triangle[2]), contact, patch);
    }
    return patch;
}

}  // namespace

ContactLoads::ContactLoads(const skeleton::Model& model) : model_(model), attach_(model) {
    if (model.surface.triangles.rows() > 0) tree_ = std::make_unique<mesh::SurfaceTree>(model.surface);
    auto cavities = std::make_shared<const skeleton::Cavities>(model);
    if (!cavities->empty()) cavities_ = std::move(cavities);
}

ContactLoads::~ContactLoads() = default;

skeleton::Load ContactLoads::operator()(const std::vector<mesh::Contact>& contacts, const Vec3& gravity) const {
    skeleton::Load load;
    load.gravity = gravity;
    for (const mesh::Contact& contact : contacts) {
        if (contact.force.isZero(0)) continue;

        std::vector<PatchPoint> patch;
        if (tree_ && contact.radius > 0) patch = sample_patch(model_.surface, contact);
        if (patch.empty()) patch.push_back({tree_ ? tree_->closest(contact.point).position : contact.point, 1});

        double area = 0;
        for (const PatchPoint& point : patch) area += point.area;
        std::vector<skeleton::Attachment> points;
        points.reserve(patch.size());
        for (const PatchPoint& point : patch) points.push_back(attach_(point.position));
        std::vector<std::pair<double, const skeleton::Attachment*>> parts;
        for (std::size_t i = 0; i < patch.size(); ++i) parts.emplace_back(patch[i].area / area, &points[i]);
        load.forces.push_back({skeleton::blend(parts), contact.force});
        if (!tree_ || !(contact.radius > 0)) continue;
        skeleton::PatchForce press{
            contact.force, mesh::mean_normal(model_.surface, contact.point, contact.radius), contact.radius, {}};
        for (const PatchPoint& point : patch) press.patch.emplace_back(point.position, point.area / area);
        load.patch_forces.push_back(std::move(press));
    }
    return load;
}

skeleton::Load ContactLoads::operator()(const MeasurementSet& set, const LoadState& state) const {
    skeleton::Load load = (*this)(state.contacts, known_gravity(set, state).value_or(Vec3::Zero()));
    load.pressure = known_pressure(state);
    if (load.pressure != 0) load.cavities = cavities_;
    return load;
}

const LoadState* acting_at(const std::vector<const LoadState*>& loads, double time) {
    for (const LoadState* load : loads) {
        if (time <= load->time * (1 + 1e-12)) return load;
    }
    return loads.back();
}

const LoadState* acting_before(const std::vector<const LoadState*>& loads) {
    return loads.size() > 1 && loads.front()->time == 0 ? loads.front() : nullptr;
}

bool is_always_loaded(const skeleton::Model& model) {
    return !skeleton::effect_force(model, rest_state(model)).isZero(0);
}

double known_pressure(const LoadState& state) { return known_part(state.pressure); }

std::optional<Vec3> known_gravity(const MeasurementSet& set, const LoadState& state) {
    if (state.gravity.allFinite()) return state.gravity;
    return set.gravity;
}

bool is_off_rest(const mesh::ToolMotion& motion) {
    return !known_part(motion.translation).isZero(0) || !known_part(motion.rotation).isZero(0);
}

bool is_known_to_act(const MeasurementSet& set, const LoadState& state) {
    const bool is_heavy = !known_gravity(set, state).value_or(Vec3::Zero()).isZero(0);
    const bool is_moved = std::ranges::any_of(state.motions, [](const auto& motion) { return is_off_rest(motion); });
    const bool is_actuated = std::ranges::any_of(state.actuations, [](const Actuation& a) { return a.value != 0; });
    return has_contact_force(state) || is_heavy || known_pressure(state) != 0 || is_moved || is_actuated;
}

}  // namespace palpate::identify
