#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "identify/loading/loads.h"
#include "identify/loading/tool_motions.h"
#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// A tool moves the body by less, or more, than its drive reports.
class SlipEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "slip",
            .kind = EffectKind::measurement,
            .meaning =
                "The true motion of a tool is a share of the reported one: it slips in its grip, or what moves it "
                "yields.",
            .parameters = {"share of <tool> [-]: true over reported motion of that tool"},
            .reveals = "markers near a tool that move less than it does, and reactions that are too small alike",
            .confused_with = {"compliant-support", "stiffening"},
            .separating_probe = "put a marker on the tool, or on the body right beside it",
            .next_probe = "fiducials",
            .why_unshown = "no tool is moved"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        std::vector<EffectNumber> result;
        for (const int tool : moved_tools(problem)) {
            // a third of the motion or so: a tool that slips by more is seen to
            result.push_back(
                {.name = "share of " + problem.rig->tools[tool].name, .unit = "1", .prior_sd = 0.3, .logarithm = true});
        }
        return result;
    }

    Action act(const Problem& problem, int, Action action, const Eigen::VectorXd& values) const override {
        const std::vector<int> tools = moved_tools(problem);
        for (mesh::ToolMotion& motion : action.motions) {
            const auto own = std::ranges::find(tools, motion.tool);
            if (own != tools.end()) motion = mesh::scaled(motion, std::exp(values[own - tools.begin()]));
        }
        return action;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto least = std::ranges::min_element(record.parameters, {}, &skeleton::EffectParameter::value);
        const auto number = static_cast<std::size_t>(least - record.parameters.begin());
        return fmt::format("A tool does not move as reported: the {} is {} of the motion.", least->name,
                           number_in_words(record, number, covariance));
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const override {
        MeasurementSet result = set;
        for (LoadState& state : result.states) {
            for (mesh::ToolMotion& motion : state.motions) {
                const auto own = std::ranges::find(record.parameters, "share of " + set.tools[motion.tool].name,
                                                   &skeleton::EffectParameter::name);
                if (own != record.parameters.end()) motion = mesh::scaled(motion, own->value);
            }
        }
        return result;
    }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.share = number_of(record, "share");
    }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override { return {{"share", "1"}}; }
    std::string why_not_driven(int tool_places) const override {
        if (tool_places < 2) return {};
        return fmt::format(
            "it is a share of the motion from rest, and the tool presses at {} places; press at one (--probes 1)",
            tool_places);
    }
    std::optional<std::uint64_t> stream() const override { return 20; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (context.set.tools.empty()) throw InvalidInput("effect 'slip' needs a tool that moves: add --tool");
        specified.positive_value("share", 1, 1);
        const auto at = [=](double x) { return specified.effect({{"share", std::exp(-x)}}); };
        // Two thirds of the motion lost are seen by eye.
        return {{.at = at, .start = 0.3, .most = std::log(3.0), .is_specified = specified.has("share")}};
    }

private:
    /// In their order; at rest in all states a tool cannot slip, and the way of one that roams is not a share of how
    /// far it presses.
    static std::vector<int> moved_tools(const Problem& problem) {
        std::vector<char> is_moved(problem.rig->tools.size(), 0), roaming = is_moved;
        for (const Stage& stage : problem.stages) {
            for (const mesh::ToolMotion& motion : stage.action.motions) {
                if (is_off_rest(motion)) is_moved[motion.tool] = 1;
                if (roams(problem.rig->tools[motion.tool], motion)) roaming[motion.tool] = 1;
            }
        }
        std::vector<int> tools;
        for (std::size_t t = 0; t < is_moved.size(); ++t)
            if (is_moved[t] && !roaming[t]) tools.push_back(static_cast<int>(t));
        return tools;
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> slip_effect() { return std::make_shared<SlipEffect>(); }

}  // namespace palpate::identify
