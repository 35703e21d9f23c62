#include "identify/diagnosis/locate/sources/source_bases.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "identify/diagnosis/locate/sources/source_laws.h"
#include "identify/diagnosis/locate/sources/source_places.h"
#include "identify/diagnosis/search/screen_plan.h"
#include "identify/effects/catalogue.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/// Makes the bases that the model answers for, action by action.
class BodySources {
public:
    BodySources(const BodyModel& model, const Problem& problem, const Refit& fit,
                const std::vector<ReadingEntry>& of_problem)
        : model_(model),
          problem_(problem),
          fit_(fit),
          entries_(of_problem),
          loads_(relative_loads(problem)),
          setting_(fit.explanation.setting()),
          material_(model.material_points(), model.material_shares(), model.size()),
          skin_(model.skin(), model.skin_areas() / model.skin_areas().sum(), model.size()),
          pieces_(model.pieces(),
                  Eigen::VectorXd::Constant(model.pieces().rows(), 1.0 / static_cast<double>(model.pieces().rows())),
                  model.size()),
          material_motion_(model.material_motion()),
          anisotropy_(find_effect("anisotropy")) {
        const auto entries = std::ssize(entries_);
        material_weights_ = material_.unit(model.material_shares());
        skin_weights_ = skin_.unit(model.skin_areas() / model.skin_areas().sum());
        normals_.resize(model.skin().rows(), 3);
        for (Eigen::Index s = 0; s < normals_.rows(); ++s)
            normals_.row(s) = model.normal_near(model.skin().row(s), 0).transpose();
        for (Eigen::Index c = 0; c < skin_.count(); ++c) {
            const Vec3 outward = normals_.transpose() * skin_weights_.col(c);
            // All round the body normals cancel out: they point nowhere then.
            constexpr double least = 0.1;
            if (outward.norm() > least) skin_.places[static_cast<std::size_t>(c)].axis = -outward.normalized();
        }
        mean_energy_ = Eigen::VectorXd::Zero(std::ssize(fit.forward.q));
        plan_ = screen_plan(*anisotropy_, model, problem, fit.explanation, fit.forward);
        const auto basis = [&](SourceKind kind, SourceForm form, int width, const std::vector<SourcePlace>& places,
                               std::optional<SourceLaw> law = {}, bool one_sided = false) {
            SourceBasis result{
                .kind = kind, .form = form, .width = width, .one_sided = one_sided, .law = law, .places = places};
            result.columns = Eigen::MatrixXd::Zero(entries, width * std::ssize(places));
            return result;
        };
        using enum SourceKind;
        bases_ = {basis(body_force, SourceForm::force, 3, material_.places),
                  basis(body_force, SourceForm::growth, 1, pieces_.places),
                  basis(stiffness, SourceForm::softening, 1, pieces_.places),
                  basis(boundary, SourceForm::traction, 3, skin_.places),
                  basis(boundary, SourceForm::normal, 1, skin_.places),
                  basis(boundary, SourceForm::normal, 1, skin_.places, SourceLaw::spring, true),
                  basis(boundary, SourceForm::support, 2, {support_place()}, SourceLaw::reaction),
                  basis(sensor, SourceForm::gain, 1, gain_places(), SourceLaw::one_probe),
                  basis(stiffness, SourceForm::set, 2, {pieces_.places.back()}, SourceLaw::with_history),
                  basis(stiffness, SourceForm::softening, 1, pieces_.places, SourceLaw::with_strain)};
        bases_[3].motions.setZero(std::ssize(problem.actions), 3 * skin_.count());
        fibres_.resize(entries, plan_.signatures.width);
        fibres_.setZero();
    }

    /// Fills in what the entries of one action feel.
    void add(const ActionAdjoint& adjoint) {
        const int k = adjoint.action;
        const Eigen::VectorXd& q = fit_.forward.q[k];
        const Action& action = fit_.forward.actions[k];
        const Eigen::MatrixXd of_material = material_motion_ * adjoint.by_force;
        const Eigen::MatrixXd of_skin = model_.skin_motion(q, setting_) * adjoint.by_force;
        const Points moved = model_.skin_positions(q, setting_) - model_.skin();
        const auto put = [&](std::size_t b, const Eigen::MatrixXd& of_coordinates) {
            bases_[b].columns.middleRows(adjoint.first, adjoint.count()) = adjoint.of_entries(of_coordinates);
        };
        put(0, spread(of_material, material_weights_));
        const Eigen::MatrixXd softer = model_.piece_force(q, setting_, action, pieces_.weights);
        ModelSetting swollen = setting_;
        constexpr double growth = 1e-4;  // small enough for forces to be in proportion, large against their rounding
        swollen.effects.growth.everywhere += growth;
        const Eigen::MatrixXd swelling = (model_.piece_force(q, swollen, action, pieces_.weights) - softer) / growth;
        put(1, adjoint.by_force.transpose() * swelling);
        put(2, adjoint.by_force.transpose() * softer);
        put(3, spread(of_skin, skin_weights_));
        put(4, directed(of_skin, -normals_, skin_weights_));
        put(5, directed(of_skin, -moved, skin_weights_));
        const Eigen::MatrixXd of_places = moved.transpose() * skin_weights_;
        bases_[3].motions.row(k) = of_places.reshaped().transpose();
        put(6, of_support(adjoint, q, action));
        bases_[7].columns.middleRows(adjoint.first, adjoint.count()) = of_gains(adjoint, q, action);
        bases_[8].columns.middleRows(adjoint.first, adjoint.count()) = of_loads_so_far(adjoint, q);
        const Eigen::VectorXd energy = energy_of_pieces(q, softer);
        mean_energy_[k] = energy.mean();
        put(9, adjoint.by_force.transpose() *
                   model_.piece_force(q, setting_, action, energy.asDiagonal() * pieces_.weights));
        const Signatures::InAction along = plan_.signatures.in_action(k, q);
        fibres_.middleRows(adjoint.first, adjoint.count()) = adjoint.felt(along.forces);
    }

    /// All of them; leaves nothing behind.
    std::vector<SourceBasis> take() {
        if (mean_energy_.maxCoeff() > 0) bases_[9].columns /= mean_energy_.maxCoeff();
        const Eigen::MatrixXd columns = plan_.columns(fibres_).columns;
        SourceBasis fibres{.kind = SourceKind::stiffness, .form = SourceForm::fibres, .columns = columns};
        fibres.places.reserve(static_cast<std::size_t>(columns.cols()));
        for (Eigen::Index c = 0; c < columns.cols(); ++c) {
            SourcePlace place = pieces_.places.back();  // everywhere
            place.axis = plan_.start(c, Eigen::VectorXd::Ones(1)).tail<3>();
            place.log_prior = -std::log(static_cast<double>(columns.cols()));
            fibres.places.push_back(place);
        }
        bases_.push_back(std::move(fibres));
        // Each probe with a gain of its own.
        SourceBasis gains = bases_[7];
        gains.form = SourceForm::gains;
        gains.law = SourceLaw::irregular;
        gains.width = static_cast<int>(gains.places.size());
        if (gains.width > 1) {
            gains.places = {gains.places.front()};
            gains.places.front().log_prior = 0;
            bases_.push_back(std::move(gains));
        }
        return std::move(bases_);
    }

private:
    SourcePlace support_place() const {
        const Vec3 centre = model_.support_points().transpose() * model_.support_shares();
        const Eigen::VectorXd squares =
            (model_.support_points().rowwise() - centre.transpose()).rowwise().squaredNorm();
        return {.centre = centre, .extent = std::sqrt(squares.dot(model_.support_shares()))};
    }

    /// A place for each probe that presses with a force.
    std::vector<SourcePlace> gain_places() const {
        std::vector<SourcePlace> places;
        for (std::size_t k = 0; k < problem_.actions.size(); ++k) {
            const std::vector<mesh::Contact>& contacts = problem_.actions[k].contacts;
            if (contacts.empty() || std::ranges::find(places, problem_.probe[k], &SourcePlace::number) != places.end())
                continue;
            places.push_back(
                {.centre = contacts.front().point, .extent = contacts.front().radius, .number = problem_.probe[k]});
        }
        for (SourcePlace& place : places) place.log_prior = -std::log(static_cast<double>(places.size()));
        return places;
    }

    /// A support that gives way moves and turns as the force and the moment on it say.
    Eigen::MatrixXd of_support(const ActionAdjoint& adjoint, const Eigen::VectorXd& q, const Action& action) const {
        const Eigen::MatrixXd base = model_.support_motion(bases_[6].places.front().centre);
        const Eigen::VectorXd pressed = base.transpose() * model_.residual(q, setting_, action);
        Eigen::MatrixXd moved(base.rows(), 2);
        moved << base.leftCols(3) * pressed.head<3>(), base.rightCols(3) * pressed.tail<3>();
        return adjoint.by_step.transpose() * moved -
               adjoint.by_force.transpose() * model_.tangent_times(q, setting_, action, moved);
    }

    /// Elastic energy of the pieces in a state, to first order about rest, each as of the smallest places around it;
    /// from the forces of softened places (dofs x places). 0 where configurations are no displacements: of links that
    /// turn.
    Eigen::VectorXd energy_of_pieces(const Eigen::VectorXd& q, const Eigen::MatrixXd& softer) const {
        if (q.size() != softer.rows()) return Eigen::VectorXd::Zero(pieces_.weights.rows());
        const auto small = std::ranges::count(pieces_.places, pieces_.places.front().radius, &SourcePlace::radius);
        const auto weights = pieces_.weights.leftCols(small);
        const Eigen::VectorXd of_places =
            (-0.5 * softer.leftCols(small).transpose() * (q - model_.rest(setting_))).cwiseMax(0);
        const Eigen::VectorXd shares = weights.colwise().sum().transpose();
        return (weights * of_places.cwiseQuotient(shares)).cwiseQuotient(weights.rowwise().sum());
    }

    Eigen::MatrixXd of_gains(const ActionAdjoint& adjoint, const Eigen::VectorXd& q, const Action& action) const {
        const std::vector<SourcePlace>& probes = bases_[7].places;
        Eigen::MatrixXd result = Eigen::MatrixXd::Zero(adjoint.count(), std::ssize(probes));
        const auto own = std::ranges::find(probes, problem_.probe[adjoint.action], &SourcePlace::number);
        if (own == probes.end()) return result;
        Eigen::VectorXd force = Eigen::VectorXd::Zero(model_.dofs());
        for (const mesh::Contact& contact : action.contacts) force += model_.contact_force(q, setting_, contact);
        result.col(own - probes.begin()) = adjoint.felt(force);
        return result;
    }

    /// A body that keeps part of what it went through is as if shares of all loads so far still acted, each at its
    /// largest: in proportion to it, and by its square over the largest of all, as where it has to be passed.
    Eigen::MatrixXd of_loads_so_far(const ActionAdjoint& adjoint, const Eigen::VectorXd& q) const {
        const auto stages = std::ssize(problem_.stages);
        Eigen::MatrixXd felt(adjoint.count(), stages);  // of each stage's contacts, where they are the largest so far
        for (Eigen::Index s = 0; s < stages; ++s) {
            Eigen::VectorXd force = Eigen::VectorXd::Zero(model_.dofs());
            for (const mesh::Contact& contact : problem_.stages[s].action.contacts)
                force += model_.contact_force(q, setting_, contact);
            felt.col(s) =
                force.isZero(0) ? Eigen::VectorXd::Zero(adjoint.count()) : Eigen::VectorXd(adjoint.felt(force));
        }
        Eigen::MatrixXd result = Eigen::MatrixXd::Zero(adjoint.count(), 2);
        for (Eigen::Index e = 0; e < adjoint.count(); ++e) {
            const int now = entries_[adjoint.first + e].state;
            std::map<int, int> largest;  // of each probe so far
            for (int s = 0; s <= now; ++s) {
                const int probe = problem_.stages[s].probe;
                if (!problem_.continuous && probe != problem_.stages[now].probe) continue;
                int& most = largest.try_emplace(probe, s).first->second;
                if (loads_[s] > loads_[most]) most = s;
            }
            for (const auto& [probe, s] : largest) {
                result(e, 0) += felt(e, s);
                result(e, 1) += loads_[s] * felt(e, s);
            }
        }
        return result;
    }

    const BodyModel& model_;
    const Problem& problem_;
    const Refit& fit_;
    const std::vector<ReadingEntry>& entries_;
    Eigen::VectorXd loads_;
    ModelSetting setting_;
    SourcePlaces material_, skin_, pieces_;
    Eigen::SparseMatrix<double> material_motion_;
    Eigen::MatrixXd material_weights_, skin_weights_;
    Points normals_;
    Eigen::VectorXd mean_energy_;  // of each action
    std::shared_ptr<const EffectHypothesis> anisotropy_;
    ScreenPlan plan_;
    Eigen::MatrixXd fibres_;
    std::vector<SourceBasis> bases_;
};

bool is_of_marker(const Problem& problem, const ReadingEntry& entry) { return problem.is_position(entry.row); }

/// Readings of one marker that are off alike.
SourceBasis markers_off(const Problem& problem, const std::vector<ReadingEntry>& entries) {
    SourceBasis basis{.kind = SourceKind::sensor, .form = SourceForm::marker, .width = 3};
    basis.columns = Eigen::MatrixXd::Zero(std::ssize(entries), 3 * Eigen::Index{problem.markers});
    basis.places.reserve(static_cast<std::size_t>(problem.markers));
    for (int m = 0; m < problem.markers; ++m) {
        basis.places.push_back(
            {.centre = problem.rest.row(m), .log_prior = -std::log(static_cast<double>(problem.markers)), .number = m});
    }
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const Eigen::Index n = entries[e].row;
        if (is_of_marker(problem, entries[e]))
            basis.columns(static_cast<Eigen::Index>(e), problem.coordinate[n]) = 1 / problem.sigma[n];
    }
    return basis;
}

/// A frame of the readings that has moved and turned about their mean.
SourceBasis frame_off(const Problem& problem, const Refit& fit, const std::vector<ReadingEntry>& entries) {
    const auto markers = problem.rest.topRows(problem.markers);
    const Vec3 centre = markers.colwise().mean();
    const double extent = std::sqrt((markers.rowwise() - centre.transpose()).rowwise().squaredNorm().mean());
    SourceBasis basis{.kind = SourceKind::sensor, .form = SourceForm::frame, .width = 6};
    basis.places = {{.centre = centre, .extent = extent}};
    basis.columns = Eigen::MatrixXd::Zero(std::ssize(entries), 6);
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const Eigen::Index n = entries[e].row;
        if (!is_of_marker(problem, entries[e])) continue;
        const int axis = problem.coordinate[n] % 3;
        const Vec3 arm = fit.forward.markers[entries[e].action].row(problem.channel(n)).transpose() - centre;
        auto row = basis.columns.row(static_cast<Eigen::Index>(e));
        row[axis] = 1 / problem.sigma[n];
        row.tail<3>() = -cross_matrix(arm).row(axis) / problem.sigma[n];
    }
    return basis;
}

}  // namespace

std::vector<SourceBasis> source_bases(const BodyModel& model, const Problem& problem, const Refit& fit,
                                      const std::vector<ReadingEntry>& entries, int threads) {
    BodySources body(model, problem, fit, entries);
    for_each_adjoint(model, problem, fit.explanation, fit.forward, entries, threads,
                     [&](const ActionAdjoint& adjoint) { body.add(adjoint); });
    std::vector<SourceBasis> bases = body.take();
    if (problem.markers > 0) {
        bases.push_back(markers_off(problem, entries));
        bases.push_back(frame_off(problem, fit, entries));
    }
    return bases;
}

}  // namespace palpate::identify
