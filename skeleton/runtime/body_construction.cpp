// A body out of a model, and what of it never changes.

#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "skeleton/effects/effect.h"
#include "skeleton/model/growth.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/runtime/body_impl.h"
#include "skeleton/runtime/kernels/motion.h"

namespace palpate::runtime {

namespace {

std::vector<std::string> what_is_not_played(const skeleton::Model& model) {
    std::vector<std::string> words;
    if (model.law == skeleton::EquilibriumLaw::linear)
        words.emplace_back("the model follows the linear law; it is played in large rotation");
    for (const skeleton::EffectRecord& effect : model.effects) {
        const skeleton::KnownEffect* known = skeleton::find_known_effect(effect.name);
        if (!known) continue;
        if (known->kind == skeleton::EffectKind::measurement)
            words.push_back(fmt::format("effect '{}' is about the measurement, not the body", effect.name));
        if (!known->not_played.empty()) words.push_back(fmt::format("effect '{}' {}", effect.name, known->not_played));
    }
    return words;
}

/// Its skin as far out as the material has grown, to be shown. Contacts and effects act on it as it hangs in the model.
skeleton::Model with_grown_skin(skeleton::Model model) {
    const fem::Growth growth = skeleton::physics_of(model.effects).growth;
    const skeleton::State rest = skeleton::rest_state(model);
    for (skeleton::Attachment& point : model.skin) point = skeleton::grown(std::move(point), rest, growth);
    return model;
}

/// Where it begins: at rest, or as large as the material has grown.
SphereRows start_rows(const skeleton::Model& model) {
    SphereRows rows = rest_rows(model);
    const skeleton::State start = skeleton::grown_start(model, skeleton::physics_of(model.effects).growth);
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        for (int c = 0; c < 3; ++c) rows[row_length * i + c] = start.x(static_cast<Eigen::Index>(i), c);
    }
    return rows;
}

}  // namespace

void BodyOptions::validate() const {
    if (damping_ratio && !(*damping_ratio >= 0 && std::isfinite(*damping_ratio)))
        throw InvalidInput(fmt::format("damping_ratio is {}; it must be at least 0", *damping_ratio));
    if (contacts < 0 || contacts > 64)
        throw InvalidInput(fmt::format("contacts is {}; it must lie in 0 to 64", contacts));
    if (!(step_tolerance > 0 && step_tolerance < 1))
        throw InvalidInput(fmt::format("step_tolerance is {}; it must lie between 0 and 1", step_tolerance));
    if (!(tool_compliance >= 1e-4 && tool_compliance <= 10))
        throw InvalidInput(fmt::format("tool_compliance is {}; it must lie in 1e-4 to 10", tool_compliance));
}

// Of the softest mode, where neither model nor options tell it: a choice. The body swings a few times and comes to
// rest; where it ends does not depend on it.
constexpr double usual_damping_ratio = 0.1;

Body::Impl::Impl(const skeleton::Model& model, const BodyOptions& how)
    : options(how),
      reordered(in_cuthill_mckee_order(model)),
      field(reordered.model),
      rig(reordered.model),
      solver(field, options.contacts, rig),
      skinning(with_grown_skin(reordered.model)),
      masses(mass_table(reordered.model, field.moves())),
      notices(what_is_not_played(model)),
      rest(start_rows(reordered.model)),
      contacts(options.contacts),
      creep(skeleton::physics_of(model.effects).creep) {
    pose = start = rest;
    for (SphereRows* rows : {&momentum, &velocity, &force}) rows->assign(rest.size(), 0.0);
    for (ContactState& contact : contacts) in_use.push_back(&contact);
    skin.resize(3 * reordered.model.skin.size());
    triangles.assign(model.surface.triangles.data(), model.surface.triangles.data() + model.surface.triangles.size());
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const bool moves = field.moves()[reordered.place[i]] != 0;
        held = held || !moves || model.spheres[i].held;
        const bool heavy = model.spheres[i].mass > 0 && model.spheres[i].inertia.determinant() > 0;
        if (moves && !heavy && massless < 0) massless = static_cast<int>(i);
    }
    if (model.damping && !options.damping_ratio) {
        damping = {model.damping->alpha, model.damping->beta};
        return;
    }
    const double ratio = options.damping_ratio.value_or(usual_damping_ratio);
    if (massless < 0 && held && ratio > 0) {
        const double softest = solver.softest_mode(rest.data());
        if (softest > 0) damping.beta = 2 * ratio / softest;
    }
}

Body::Body(const std::filesystem::path& model, const BodyOptions& options)
    : Body(skeleton::read_model(model), options) {}
Body::Body(const skeleton::Model& model, const BodyOptions& options) {
    options.validate();
    impl_ = std::make_unique<Impl>(model, options);
}
Body::~Body() = default;
Body::Body(Body&&) noexcept = default;
Body& Body::operator=(Body&&) noexcept = default;

const std::vector<std::string>& Body::notices() const { return impl_->notices; }
int Body::sphere_count() const { return static_cast<int>(impl_->reordered.model.spheres.size()); }
int Body::link_count() const { return static_cast<int>(impl_->reordered.model.links.size()); }
int Body::vertex_count() const { return static_cast<int>(impl_->reordered.model.skin.size()); }

const std::vector<int>& Body::triangles() const { return impl_->triangles; }

}  // namespace palpate::runtime
