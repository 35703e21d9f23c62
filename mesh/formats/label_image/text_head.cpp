#include "mesh/formats/label_image/text_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "mesh/errors.h"

namespace palpate::mesh {

const std::string& TextHeader::at(const std::string& key) const {
    const auto found = fields_.find(key);
    if (found == fields_.end())
        throw InvalidInput(
            fmt::format("{}: its head does not tell '{}'. Export the image again.", file_.string(), key));
    return found->second;
}

std::string TextHeader::value_or(const std::string& key, const std::string& fallback) const {
    const auto found = fields_.find(key);
    return found == fields_.end() ? fallback : found->second;
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string in_lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

}  // namespace palpate::mesh
