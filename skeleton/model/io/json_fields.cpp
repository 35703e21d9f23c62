#include "skeleton/model/io/json_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::skeleton {

void JsonField::complain(const std::string& what) const {
    throw InvalidInput(fmt::format("{}: {}{}{}", file_, path_, path_.empty() ? "" : ": ", what));
}

void JsonField::fail(const std::string& allowed) const {
    using Handler = nlohmann::ordered_json::error_handler_t;
    complain(fmt::format("is {}, but must be {}", mesh::cited(json_->dump(-1, ' ', false, Handler::replace)), allowed));
}

bool JsonField::has(const std::string& key) const { return json_->is_object() && json_->contains(key); }

JsonField JsonField::operator[](const std::string& key) const {
    if (!json_->is_object()) fail("an object");
    if (!json_->contains(key)) complain(fmt::format("the field '{}' is missing", key));
    return {json_->at(key), file_, path_.empty() ? key : path_ + "." + key};
}

void JsonField::allow_only(const std::vector<std::string>& known) const {
    for (const std::string& key : keys()) {
        const bool free = path_.empty() && key.starts_with("x-");
        if (!free && std::find(known.begin(), known.end(), key) == known.end())
            complain(fmt::format("the field {} is not known{}; known are {}", mesh::cited(key),
                                 mesh::suggestion(key, known), mesh::listed(known)));
    }
}

std::vector<std::string> JsonField::keys() const {
    if (!json_->is_object()) fail("an object");
    std::vector<std::string> keys;
    for (const auto& [key, value] : json_->items()) keys.push_back(key);
    return keys;
}

bool JsonField::is_list() const { return json_->is_array(); }

std::vector<JsonField> JsonField::list() const {
    if (!json_->is_array()) fail("a list");
    std::vector<JsonField> elements;
    elements.reserve(json_->size());
    for (const nlohmann::ordered_json& element : *json_)
        elements.push_back({element, file_, fmt::format("{}[{}]", path_, elements.size())});
    return elements;
}

std::vector<JsonField> JsonField::list(size_t size) const {
    if (!json_->is_array() || json_->size() != size) fail(fmt::format("a list of {}", size));
    return list();
}

double JsonField::number() const {
    if (!json_->is_number() || !std::isfinite(json_->get<double>())) fail("a number");
    return json_->get<double>();
}

double JsonField::number_at_least(double least) const {
    if (!json_->is_number() || !(number() >= least)) fail(fmt::format("a number of at least {}", least));
    return number();
}

double JsonField::positive_number() const {
    if (!json_->is_number() || !(number() > 0)) fail("a number above 0");
    return number();
}

double JsonField::number_between(double least, double most) const {
    if (!json_->is_number() || !(number() >= least && number() <= most))
        fail(fmt::format("a number from {} to {}", least, most));
    return number();
}

int JsonField::index(size_t end) const {
    const bool fits = json_->is_number_unsigned() && json_->get<std::uint64_t>() < end;
    if (!fits)
        fail(end > 0 ? fmt::format("a whole number from 0 to {}", end - 1) : "absent: there is nothing to point at");
    return json_->get<int>();
}

bool JsonField::boolean() const {
    if (!json_->is_boolean()) fail("true or false");
    return json_->get<bool>();
}

std::string JsonField::text() const {
    if (!json_->is_string()) fail("a text");
    return json_->get<std::string>();
}

Vec3 JsonField::vector() const {
    if (!json_->is_array() || json_->size() != 3) fail("three numbers");
    Vec3 v;
    const std::vector<JsonField> parts = list();
    for (int c = 0; c < 3; ++c) v[c] = parts[c].number();
    return v;
}

size_t JsonField::choice(const std::vector<std::string>& names) const {
    const auto found = json_->is_string() ? std::find(names.begin(), names.end(), text()) : names.end();
    if (found == names.end()) fail("one of " + mesh::listed(names));
    return static_cast<size_t>(found - names.begin());
}

}  // namespace palpate::skeleton
