#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "mesh/types.h"

namespace palpate::skeleton {

/// A value of a JSON file and where it stands; every message names file, element, value and what is allowed. For the
/// readers of this folder only.
class JsonField {
public:
    /// The whole of `file`. `json` must outlive this and all that come out of it.
    JsonField(const nlohmann::ordered_json& json, std::string file) : json_(&json), file_(std::move(file)) {}

    /// A field of this object. @throws InvalidInput when there is none.
    JsonField operator[](const std::string& key) const;
    bool has(const std::string& key) const;
    /// @throws InvalidInput when this is no object, or has a field that is not one of `known`; in the file's outermost
    /// object names that begin with "x-" are free.
    void allow_only(const std::vector<std::string>& known) const;
    std::vector<std::string> keys() const;

    bool is_list() const;
    /// The elements of this list. @throws InvalidInput when it is none.
    std::vector<JsonField> list() const;
    /// The same, with so many of them.
    std::vector<JsonField> list(size_t size) const;

    double number() const;  // finite
    double number_at_least(double least) const;
    double positive_number() const;
    double number_between(double least, double most) const;
    int index(size_t end) const;  // a whole number in [0, end)
    bool boolean() const;
    std::string text() const;
    Vec3 vector() const;
    /// The place in `names` of the text that this is.
    size_t choice(const std::vector<std::string>& names) const;

    /// "model.json: links[17].flexion: is '-3', but must be " and what is allowed.
    [[noreturn]] void fail(const std::string& allowed) const;
    /// The same without the value.
    [[noreturn]] void complain(const std::string& what) const;

private:
    JsonField(const nlohmann::ordered_json& json, const std::string& file, std::string path)
        : json_(&json), file_(file), path_(std::move(path)) {}

    const nlohmann::ordered_json* json_;
    std::string file_;
    std::string path_;  // "links[17].flexion", empty for the whole
};

}  // namespace palpate::skeleton
