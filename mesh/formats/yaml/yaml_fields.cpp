#include "mesh/formats/yaml/yaml_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "mesh/errors.h"
#include "mesh/formats/yaml/yaml_tree.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

using Kind = YamlNode::Kind;

struct YamlFields::Impl {
    std::filesystem::path file;
    std::string prefix;  // of the names in messages, as "noise."
    YamlNode node;       // the mapping
    std::set<std::string> asked;
    std::map<std::string, std::vector<YamlFields>> inner;  // mappings that were handed out

    const YamlNode* find(const std::string& key) {
        asked.insert(key);
        const auto found = std::ranges::find(node.keys, key);
        return found == node.keys.end() ? nullptr : &node.items[static_cast<std::size_t>(found - node.keys.begin())];
    }

    const YamlNode& get(const std::string& key) {
        if (const YamlNode* found = find(key)) return *found;
        throw InvalidInput(fmt::format("{}, line {}: the field '{}{}' is missing{}.", file.filename().string(),
                                       node.line, prefix, key, misspelled(key)));
    }

    /// Where a field of nearly that name stands.
    std::string misspelled(const std::string& key) const {
        for (const auto& other : node.keys)
            if (!suggestion(key, {other}).empty()) return fmt::format("; {} stands there instead", cited(other));
        return {};
    }

    std::string where(const std::string& key, int line) const {
        return fmt::format("{}, line {}, {}{}", file.filename().string(), line, prefix, key);
    }

    [[noreturn]] void refuse(const std::string& key, const YamlNode& value, const std::string& wanted) const {
        static const std::map<Kind, std::string> words{
            {Kind::empty, "nothing"}, {Kind::sequence, "a list"}, {Kind::mapping, "a mapping"}};
        const std::string found = value.kind == Kind::scalar ? cited(value.value) : words.at(value.kind);
        throw InvalidInput(fmt::format("{}: {} stands here, {} is needed.", where(key, value.line), found, wanted));
    }

    double number(const std::string& key, const YamlNode& value) const {
        const auto parsed = value.kind == Kind::scalar ? parse_number(value.value) : std::nullopt;
        if (!parsed) refuse(key, value, "a finite number");
        return *parsed;
    }

    Vec3 vector(const std::string& key, const YamlNode& value) const {
        if (value.kind != Kind::sequence) refuse(key, value, "a list of three numbers");
        if (value.items.size() != 3)
            throw InvalidInput(fmt::format("{}: {} numbers stand here, three are needed: [x, y, z].",
                                           where(key, value.line), value.items.size()));
        return {number(key, value.items[0]), number(key, value.items[1]), number(key, value.items[2])};
    }

    const YamlNode& list(const std::string& key, const std::string& wanted) {
        const YamlNode& value = get(key);
        if (value.kind != Kind::sequence) refuse(key, value, wanted);
        return value;
    }

    YamlFields fields(const std::string& key, const YamlNode& value) const {
        if (value.kind != Kind::mapping) refuse(key, value, "a mapping (name: value)");
        return YamlFields(std::make_shared<Impl>(Impl{file, prefix + key + ".", value, {}, {}}));
    }
};

YamlFields YamlFields::from_file(const std::filesystem::path& file) {
    constexpr std::uintmax_t most_bytes = 1 << 20;
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (!error && bytes > most_bytes)
        throw InvalidInput(fmt::format("{}: {} bytes are more than a file of settings may have ({}).", file.string(),
                                       bytes, most_bytes));
    return from_text(read_text(file), file);
}

YamlFields YamlFields::from_text(const std::string& text, const std::filesystem::path& name) {
    YamlNode root = parse_yaml(text, name);
    if (root.kind != Kind::mapping)
        throw InvalidInput(fmt::format("{}: {}, lines of 'name: value' are needed.", name.filename().string(),
                                       root.kind == Kind::empty ? "the file is empty" : "this is no mapping"));
    return YamlFields(std::make_shared<Impl>(Impl{name, "", std::move(root), {}, {}}));
}

bool YamlFields::has(const std::string& key) const { return impl_->find(key) != nullptr; }

bool YamlFields::is_null(const std::string& key) const { return impl_->get(key).kind == Kind::empty; }

std::string YamlFields::text(const std::string& key) const {
    const YamlNode& value = impl_->get(key);
    if (value.kind != Kind::scalar) impl_->refuse(key, value, "a text");
    return value.value;
}

std::string YamlFields::choice(const std::string& key, const std::vector<std::string>& allowed) const {
    std::string value = text(key);
    if (std::ranges::find(allowed, value) == allowed.end())
        throw InvalidInput(fmt::format("{}: {} is not allowed{}. Allowed: {}.", where(key), cited(value),
                                       suggestion(value, allowed), listed(allowed)));
    return value;
}

double YamlFields::number(const std::string& key) const { return impl_->number(key, impl_->get(key)); }

double YamlFields::number(const std::string& key, double least, double most) const {
    const double value = number(key);
    if (value < least || value > most)
        throw InvalidInput(fmt::format("{}: {} is outside [{}, {}].", where(key), value, least, most));
    return value;
}

int YamlFields::integer(const std::string& key, int least, int most) const {
    const YamlNode& value = impl_->get(key);
    const auto parsed = value.kind == Kind::scalar ? parse_integer(value.value) : std::nullopt;
    if (!parsed) impl_->refuse(key, value, "a whole number");
    if (*parsed < least || *parsed > most)
        throw InvalidInput(fmt::format("{}: {} is outside [{}, {}].", where(key), *parsed, least, most));
    return *parsed;
}

bool YamlFields::boolean(const std::string& key) const { return choice(key, {"true", "false"}) == "true"; }

Vec3 YamlFields::vector(const std::string& key) const { return impl_->vector(key, impl_->get(key)); }

std::vector<Vec3> YamlFields::vectors(const std::string& key) const {
    std::vector<Vec3> values;
    for (const YamlNode& item : impl_->list(key, "a list of vectors").items) values.push_back(impl_->vector(key, item));
    return values;
}

std::vector<double> YamlFields::numbers(const std::string& key) const {
    std::vector<double> values;
    for (const YamlNode& item : impl_->list(key, "a list of numbers").items) values.push_back(impl_->number(key, item));
    return values;
}

std::vector<std::string> YamlFields::texts(const std::string& key) const {
    std::vector<std::string> values;
    for (const YamlNode& item : impl_->list(key, "a list of texts").items) {
        if (item.kind != Kind::scalar) impl_->refuse(key, item, "a text");
        values.push_back(item.value);
    }
    return values;
}

YamlFields YamlFields::mapping(const std::string& key) const {
    auto& inner = impl_->inner[key];
    if (inner.empty()) inner.push_back(impl_->fields(key, impl_->get(key)));
    return inner.front();
}

std::vector<YamlFields> YamlFields::mappings(const std::string& key) const {
    auto& inner = impl_->inner[key];
    if (inner.empty())
        for (const YamlNode& item : impl_->list(key, "a list of mappings").items)
            inner.push_back(impl_->fields(key, item));
    return inner;
}

std::vector<YamlFields> YamlFields::mapping_or_mappings(const std::string& key) const {
    if (impl_->get(key).kind == Kind::mapping) return {mapping(key)};
    return mappings(key);
}

void YamlFields::finish() const {
    const std::vector<std::string> known(impl_->asked.begin(), impl_->asked.end());
    for (std::size_t i = 0; i < impl_->node.keys.size(); ++i) {
        const std::string& key = impl_->node.keys[i];
        if (!impl_->asked.contains(key))
            throw InvalidInput(fmt::format("{}, line {}: unknown field {}{}. Known here: {}.",
                                           file().filename().string(), impl_->node.key_lines[i],
                                           cited(impl_->prefix + key), suggestion(key, known), listed(known)));
    }
}

std::string YamlFields::where(const std::string& key) const {
    const auto& node = impl_->node;
    const auto found = static_cast<std::size_t>(std::ranges::find(node.keys, key) - node.keys.begin());
    const int line = found == node.keys.size() ? node.line : node.key_lines[found];
    return impl_->where(key, line);
}

const std::filesystem::path& YamlFields::file() const { return impl_->file; }

}  // namespace palpate::mesh
