#pragma once

#include <optional>
#include <string>

namespace palpate::identify {

/// A text in UTF-8 whose lines end with '\n', whatever it was written as.
struct DecodedText {
    std::string text;
    std::string encoding;  // in words, for a note
};

/// A byte order mark, zeros in every other byte, or what is valid UTF-8 tells the encoding; all else is Windows-1252,
/// of which Latin-1 is a part. @param encoding "utf-8", "utf-16" or "latin-1" where it is told
/// @return none where the bytes are no text.
std::optional<DecodedText> decode_text(const std::string& bytes, const std::optional<std::string>& encoding = {});

}  // namespace palpate::identify
