#include "pipeline/case/settings/declare.h"

#include <algorithm>

namespace palpate::pipeline::declare {

CaseSetting declared(std::string_view place, std::string help) {
    CaseSetting setting;
    const std::size_t dot = place.find('.');
    if (dot != std::string_view::npos) setting.section = place.substr(0, dot);
    setting.key = place.substr(dot == std::string_view::npos ? 0 : dot + 1);
    setting.help = std::move(help);
    setting.stage = setting.section;
    return setting;
}

CaseSetting with_flag(std::string group, CaseSetting setting) {
    setting.flag = "--" + setting.key;
    std::ranges::replace(setting.flag, '_', '-');
    setting.group = std::move(group);
    if (setting.schema.value("type", "") == "boolean") setting.flag_value = "true";
    return setting;
}

CaseSetting of_stage(std::string stage, CaseSetting setting) {
    setting.stage = std::move(stage);
    return setting;
}

}  // namespace palpate::pipeline::declare
