#include "pipeline/case/settings/overrides.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "pipeline/case/settings/settings.h"

namespace palpate::pipeline {
namespace {

std::string flag_or_place(const CaseSetting& setting) { return setting.flag.empty() ? setting.place() : setting.flag; }

/// Puts the value into the case; why it cannot, in words, where it cannot.
std::string objection_on_reading(const CaseSetting& setting, const std::string& value, Case& c) {
    const std::string name = "value";
    try {
        setting.read(mesh::YamlFields::from_text(setting.key + ": " + value + "\n", name), c);
    } catch (const IoError& error) {
        return error.what();
    } catch (const InvalidInput& error) {
        const std::string message = error.what(), where = fmt::format("{}, line 1, {}: ", name, setting.key);
        return message.starts_with(where) ? message.substr(where.size()) : message;
    }
    return {};
}

}  // namespace

void CaseOverrides::set(std::string_view place, std::string value) {
    overrides_[setting_at(place).place()] = std::move(value);
}

void CaseOverrides::set(std::string_view place, double value) { set(place, fmt::format("{}", value)); }

bool CaseOverrides::has(std::string_view place) const { return overrides_.contains(place); }

void CaseOverrides::apply(Case& c) const {
    for (const auto& [place, value] : overrides_) {
        const CaseSetting& setting = setting_at(place);
        const std::string objection = objection_on_reading(setting, value, c);
        if (!objection.empty()) throw InvalidInput(fmt::format("{}: {}", flag_or_place(setting), objection));
    }
    if (seed) c.identify.seed = *seed;
}

Case CaseOverrides::on_defaults() const {
    Case c;
    apply(c);
    return c;
}

std::vector<std::string> CaseOverrides::flags() const {
    std::vector<std::string> words;
    for (const auto& [place, value] : overrides_) {
        const CaseSetting& setting = setting_at(place);
        if (setting.flag.empty()) throw std::logic_error(fmt::format("there is no flag for {}", place));
        words.push_back(setting.flag);
        if (setting.flag_value.empty()) words.push_back(value);
    }
    if (seed) words.insert(words.end(), {"--seed", fmt::format("{}", *seed)});
    return words;
}

std::string objection_to_value(std::string_view place, const std::string& value) {
    Case c;
    return objection_on_reading(setting_at(place), value, c);
}

}  // namespace palpate::pipeline
