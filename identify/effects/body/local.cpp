#include <fmt/format.h>

#include <cmath>

#include "fem/effects/local/local_force.h"
#include "fem/effects/local/local_springs.h"
#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/centre_numbers.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

// Numbers of every effect that is in a part of the body: its centre, and the logarithm of its radius.
constexpr Eigen::Index place_numbers = 4;

std::vector<EffectNumber> numbers_of_place(const BodyModel& model) {
    std::vector<EffectNumber> result = centre_numbers(model);
    // From a twentieth of the body to all of it.
    const double radius = std::log(0.2 * model.size());
    result.push_back(
        {.name = "radius", .unit = "mm", .start = radius, .prior_mean = radius, .prior_sd = 0.8, .logarithm = true});
    return result;
}

fem::Locality locality_of(const Eigen::VectorXd& values) { return {values.head<3>(), std::exp(values[3])}; }

const char* const place_in_text = "cx, cy, cz [mm]: the middle of that part";
const char* const radius_in_text = "radius [mm]: one standard deviation of a Gaussian weight that stands for it";

std::string place_in_words(const skeleton::EffectRecord& record) {
    const auto& p = record.parameters;
    return fmt::format("around ({:.1f}, {:.1f}, {:.1f}) mm, within {:.2g} mm", p[0].value, p[1].value, p[2].value,
                       p[3].value);
}

double young_of(const BodyModel& model) {
    Eigen::VectorXd theta(std::ssize(model.parameters()));
    for (Eigen::Index p = 0; p < theta.size(); ++p) theta[p] = model.parameters()[p].start;
    return model.young({.law = 0, .theta = theta, .effects = {}});
}

/// A force that nobody has named: what it comes from is not known, only where it acts.
class LocalForceEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "local-force",
            .kind = EffectKind::body,
            .meaning =
                "A constant force acts within a part of the body: a magnet, a wire, a hose that weighs on it. "
                "'improve --residual' finds it; no diagnosis names it.",
            .parameters = {place_in_text, radius_in_text, "fx, fy, fz [N]: the force in all"},
            .reveals = "an error that is there without any load, about one place",
            .confused_with = {"gravity", "prestress", "misalignment"},
            .separating_probe = "read the unloaded body, with markers close to that place",
            .next_probe = "orientation"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem& problem) const override {
        std::vector<EffectNumber> result = numbers_of_place(model);
        const double force = typical_force(model, problem);
        for (const char* component : {"fx", "fy", "fz"})
            result.push_back({.name = component, .unit = "N", .prior_sd = force});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<fem::LocalForce>(locality_of(values), values.segment<3>(place_numbers)));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return sentence_with(record, Eigen::MatrixXd::Zero(place_numbers + 3, place_numbers + 3));
    }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto& p = record.parameters;
        const Vec3 force(p[4].value, p[5].value, p[6].value);
        return fmt::format(
            "A force of {} acts within the body, {}.",
            vector_in_words(force, covariance.block<3, 3>(place_numbers, place_numbers), 1, "N", "towards"),
            place_in_words(record));
    }

private:
    /// The largest of a contact in the set; of a set without contacts, what would press the body by some hundredths.
    static double typical_force(const BodyModel& model, const Problem& problem) {
        double most = 0;
        for (const Action& action : problem.actions)
            for (const mesh::Contact& contact : action.contacts) most = std::max(most, contact.force.norm());
        constexpr double hundredth = 0.01;  // of E size^2: the force that strains a cube by as much
        return most > 0 ? most : hundredth * young_of(model) * model.size() * model.size();
    }
};

/// Something that nobody has named holds the skin.
class LocalSpringsEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "local-springs",
            .kind = EffectKind::body,
            .meaning =
                "Something holds a part of the skin, as springs to where it rests: a hose, a ligament, a cable. "
                "'improve --residual' finds it; no diagnosis names it.",
            .parameters = {place_in_text, radius_in_text, "stiffness [N/mm]: of all springs together"},
            .reveals = "one place moves too little, under whatever probe",
            .confused_with = {"inclusion", "contact", "stiffening"},
            .separating_probe = "push that place to either side, and read how far it moves",
            .next_probe = "load"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        std::vector<EffectNumber> result = numbers_of_place(model);
        // From some that hardly hold a slender body to some that hold it as a wall does.
        const double stiffness = std::log(0.02 * young_of(model) * model.size());
        result.push_back({.name = "stiffness",
                          .unit = "N/mm",
                          .start = stiffness,
                          .prior_mean = stiffness,
                          .prior_sd = 2.5,
                          .logarithm = true});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<fem::LocalSprings>(locality_of(values), std::exp(values[place_numbers])));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("Something holds the skin {}, as springs of {} N/mm in all.", place_in_words(record),
                           number_in_words(record, place_numbers, covariance));
    }
};

/// A part of the material that nobody has named has grown: it dried, took up a liquid, is warmer than the rest.
class LocalSwellingEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "local-swelling",
            .kind = EffectKind::body,
            .meaning =
                "A part of the material has grown or shrunk since the rest shape was taken: it took up a liquid, "
                "dried, or is warmer than the rest. 'improve --residual' finds it; no diagnosis names it.",
            .parameters = {place_in_text, radius_in_text,
                           "growth [-]: of every free length in its middle; below 0 it shrank"},
            .reveals = "an error that is there without any load, away from one place or towards it",
            .confused_with = {"swelling", "prestress", "local-force"},
            .separating_probe = "read the unloaded body, with markers all round that place",
            .next_probe = "fiducials"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        std::vector<EffectNumber> result = numbers_of_place(model);
        // A third of the volume there, more or less. With the least of an even swelling some material is left.
        result.push_back({.name = "growth", .unit = "1", .prior_sd = 0.1, .least = -0.4});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.growth.parts.push_back({locality_of(values), values[place_numbers]});
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const double growth = record.parameters[place_numbers].value;
        return fmt::format(
            "The material has {} by up to {} % in every free length {}.", growth < 0 ? "shrunk" : "grown",
            number_in_words(record, place_numbers, covariance, growth < 0 ? -100 : 100), place_in_words(record));
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> local_force_effect() { return std::make_shared<LocalForceEffect>(); }
std::shared_ptr<const EffectHypothesis> local_springs_effect() { return std::make_shared<LocalSpringsEffect>(); }
std::shared_ptr<const EffectHypothesis> local_swelling_effect() { return std::make_shared<LocalSwellingEffect>(); }

}  // namespace palpate::identify
