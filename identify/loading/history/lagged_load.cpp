#include "identify/loading/history/lagged_load.h"

#include <algorithm>

#include "identify/loading/contact_sum.h"

namespace palpate::identify {

InstantBetween place_among(const std::vector<double>& times, double instant) {
    const auto last = static_cast<int>(times.size()) - 1;
    const auto later = static_cast<int>(std::ranges::upper_bound(times, instant) - times.begin());
    if (later > last) return {last, last, 1};
    if (later > 0) return {later - 1, later, (instant - times[later - 1]) / (times[later] - times[later - 1])};
    if (!(times.front() > 0)) return {0, 0, 1};
    return {-1, 0, std::max(0.0, instant) / times.front()};
}

std::vector<mesh::Contact> between(const std::vector<mesh::Contact>& before, const std::vector<mesh::Contact>& after,
                                   double share) {
    std::vector<mesh::Contact> result;
    const auto add = [&](const std::vector<mesh::Contact>& contacts, double factor) {
        if (factor == 0) return;
        for (const mesh::Contact& contact : contacts) add_contact(result, contact, factor);
    };
    add(before, 1 - share);
    add(after, share);
    return result;
}

std::vector<mesh::ActuatorSetting> between(const std::vector<mesh::ActuatorSetting>& before,
                                           const std::vector<mesh::ActuatorSetting>& after, double share) {
    std::vector<mesh::ActuatorSetting> result;
    const auto add = [&](const mesh::ActuatorSetting& setting, double factor) {
        const auto there = std::ranges::find(result, setting.actuator, &mesh::ActuatorSetting::actuator);
        if (there == result.end()) {
            result.push_back({setting.actuator, factor * setting.value, setting.earlier});
        } else {
            there->value += factor * setting.value;
            there->earlier = setting.earlier;
        }
    };
    for (const mesh::ActuatorSetting& setting : before) add(setting, 1 - share);
    for (const mesh::ActuatorSetting& setting : after) add(setting, share);
    return result;
}

std::vector<double> since_largest(const std::vector<double>& before, double now) {
    const auto largest = std::ranges::max_element(before);
    return largest == before.end() || *largest <= now ? std::vector<double>{}
                                                      : std::vector<double>(largest, before.end());
}

std::vector<mesh::ToolMotion> between(const std::vector<mesh::ToolMotion>& before,
                                      const std::vector<mesh::ToolMotion>& after, double share,
                                      std::vector<mesh::ToolMotion> now) {
    for (mesh::ToolMotion& motion : now) {
        const auto from = std::ranges::find(before, motion.tool, &mesh::ToolMotion::tool);
        const auto to = std::ranges::find(after, motion.tool, &mesh::ToolMotion::tool);
        if (from == before.end() || to == after.end()) continue;
        motion.translation = (1 - share) * from->translation + share * to->translation;
        motion.rotation = (1 - share) * from->rotation + share * to->rotation;
    }
    return now;
}

}  // namespace palpate::identify
