#include "identify/measurements/files/rig/rig_yaml.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {

std::string read_own_name(const mesh::YamlFields& item, const std::vector<std::string>& taken) {
    constexpr std::size_t longest = 60;
    std::string name = item.text("name");
    const bool is_plain = !name.empty() && name.size() <= longest && name.find_first_of(",\"#\t\r\n") == name.npos &&
                          name.front() != ' ' && name.back() != ' ' &&
                          std::ranges::none_of(name, [](unsigned char c) { return c < 0x20; });
    if (!is_plain)
        throw InvalidInput(
            fmt::format("{}: {} is no name for a table's cell. Give one of 1 to {} letters without comma, quote and #, "
                        "and without a blank at its ends.",
                        item.where("name"), mesh::cited(name), longest));
    if (std::ranges::find(taken, name) != taken.end())
        throw InvalidInput(
            fmt::format("{}: '{}' is the name of another one already. Give each its own.", item.where("name"), name));
    return name;
}

std::string yaml_text(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20)
            result += fmt::format("\\x{:02x}", c);
        else
            result += c;
    }
    return result + "\"";
}

std::string yaml_list(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

}  // namespace palpate::identify
