#include <fmt/format.h>

#include <numbers>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

/// The frame of the camera is not that of the model: readings are moved and turned as one, in every state,
///   y = c + t + R(w) (x - c), c the centre of the markers at rest.
class MisalignmentEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "misalignment",
            .kind = EffectKind::measurement,
            .meaning = "The readings' frame is moved and turned against the model's, alike in every state.",
            .parameters = {"tx, ty, tz [mm]: shift of the markers' centre",
                           "rx, ry, rz [rad]: rotation vector about it"},
            .reveals = "the same rigid motion of all markers in every state, those next to the supports too",
            .confused_with = {"gravity", "prestress"},
            .separating_probe = "read fiducials that are fixed to the support",
            .next_probe = "fiducials"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        std::vector<EffectNumber> result;
        for (const char* axis : {"tx", "ty", "tz"}) {
            result.push_back({.name = axis, .unit = "mm", .prior_sd = 0.02 * model.size()});
        }
        for (const char* axis : {"rx", "ry", "rz"}) result.push_back({.name = axis, .unit = "rad", .prior_sd = 0.03});
        return result;
    }

    Points see(const Problem& problem, const Points& markers, const Eigen::VectorXd& values) const override {
        const Eigen::RowVector3d c = problem.rest.topRows(problem.markers).colwise().mean();
        const Mat3 R = skeleton::rotation(values.tail<3>());
        return ((markers.rowwise() - c) * R.transpose()).rowwise() + (c + values.head<3>().transpose());
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return sentence_with(record, Eigen::MatrixXd::Zero(6, 6));
    }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto& p = record.parameters;
        const Vec3 t(p[0].value, p[1].value, p[2].value), w(p[3].value, p[4].value, p[5].value);
        constexpr double degree = std::numbers::pi / 180;
        return fmt::format(
            "The readings are misaligned: their frame is off by {} and turned by {} against the model's.",
            vector_in_words(t, covariance.topLeftCorner<3, 3>(), 1, "mm"),
            vector_in_words(w, covariance.bottomRightCorner<3, 3>(), degree, "degrees", "about"));
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const override {
        // x = c + R^T (y - c - t)
        const auto& p = record.parameters;
        const Vec3 t(p[0].value, p[1].value, p[2].value), w(p[3].value, p[4].value, p[5].value);
        Vec3 c = Vec3::Zero();
        for (const Marker& marker : set.markers) c += marker.rest / static_cast<double>(set.markers.size());
        const Mat3 R = skeleton::rotation(w);
        MeasurementSet result = set;
        for (LoadState& state : result.states) {
            for (Reading& reading : state.readings) {
                reading.position = c + R.transpose() * (reading.position - c - t);
            }
        }
        return result;
    }

    bool is_of_readings() const override { return true; }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.shift = {number_of(record, "tx"), number_of(record, "ty"), number_of(record, "tz")};
        conditions.turn = {number_of(record, "rx"), number_of(record, "ry"), number_of(record, "rz")};
    }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override {
        return {{"tx", "mm"}, {"ty", "mm"}, {"tz", "mm"}, {"rx", "rad"}, {"ry", "rad"}, {"rz", "rad"}};
    }
    std::optional<std::uint64_t> stream() const override { return 13; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const double size = context.model.size();
        const Vec3 t0 = random_direction(context.random), w0 = random_direction(context.random);
        const bool is_specified = specified.has_any({"tx", "ty", "tz", "rx", "ry", "rz"});
        const auto at = [=](double x) {
            // A turn about the centre moves markers by about a third of the size times its angle.
            const double s = is_specified ? 0 : x;
            const Vec3 t = specified.vector({"tx", "ty", "tz"}, s * size * t0),
                       w = specified.vector({"rx", "ry", "rz"}, 3 * s * w0);
            return specified.effect(
                {{"tx", t.x()}, {"ty", t.y()}, {"tz", t.z()}, {"rx", w.x()}, {"ry", w.y()}, {"rz", w.z()}});
        };
        return {{.at = at, .start = 0.005, .most = 0.2, .is_specified = is_specified}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> misalignment_effect() { return std::make_shared<MisalignmentEffect>(); }

}  // namespace palpate::identify
