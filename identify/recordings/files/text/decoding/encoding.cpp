#include "identify/recordings/files/text/decoding/encoding.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

void append_utf8(std::uint32_t code, std::string& text) {
    const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0 | (code >> 6));
        put(0x80 | (code & 0x3F));
    } else if (code < 0x10000) {
        put(0xE0 | (code >> 12));
        put(0x80 | ((code >> 6) & 0x3F));
        put(0x80 | (code & 0x3F));
    } else {
        put(0xF0 | (code >> 18));
        put(0x80 | ((code >> 12) & 0x3F));
        put(0x80 | ((code >> 6) & 0x3F));
        put(0x80 | (code & 0x3F));
    }
}

constexpr std::uint32_t replacement = 0xFFFD;  // for what is half of a pair

std::string from_utf16(std::string_view bytes, bool is_big_endian) {
    const auto unit = [&](std::size_t i) {
        const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
        return static_cast<std::uint32_t>(is_big_endian ? first << 8 | second : second << 8 | first);
    };
    std::string text;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t code = unit(i);
        if (code >= 0xD800 && code < 0xE000) {
            const std::uint32_t low = i + 3 < bytes.size() ? unit(i + 2) : 0;
            const bool is_pair = code < 0xDC00 && low >= 0xDC00 && low < 0xE000;
            code = is_pair ? 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00) : replacement;
            if (is_pair) i += 2;
        }
        append_utf8(code, text);
    }
    return text;
}

std::string from_windows_1252(std::string_view bytes) {
    // what stands at 0x80 to 0x9F; all others are their own code
    constexpr std::array<std::uint32_t, 32> middle{0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                   0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD,
                                                   0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                   0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};
    std::string text;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        append_utf8(byte >= 0x80 && byte < 0xA0 ? middle.at(byte - 0x80) : byte, text);
    }
    return text;
}

/// Both "\r\n" and a lone '\r' become '\n'.
std::string with_own_line_ends(const std::string& text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\r')
            result += text[i];
        else if (i + 1 == text.size() || text[i + 1] != '\n')
            result += '\n';
    }
    return result;
}

/// Of UTF-16 without a mark: text of the West has a zero in every other byte. 0: it is none.
char utf16_order(std::string_view bytes) {
    constexpr std::size_t looked_at = 512;  // bytes of the head: some lines
    std::array<std::size_t, 2> zeros{};
    const std::size_t size = std::min(bytes.size(), looked_at) / 2 * 2;
    for (std::size_t i = 0; i < size; ++i)
        if (bytes[i] == '\0') ++zeros[i % 2];
    if (size == 0 || zeros[0] + zeros[1] < size / 4 || (zeros[0] > 0 && zeros[1] > 0)) return 0;
    // The other bytes are letters, not the small numbers of a binary file.
    const bool has_controls = std::any_of(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), [](char c) {
        return c != '\0' && static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r' && c != '\n';
    });
    return has_controls ? '\0' : zeros[0] == 0 ? 'l' : 'b';
}

/// Bytes that no text has, but binary files soon.
bool is_binary(std::string_view bytes) {
    constexpr std::size_t looked_at = 4096;  // bytes of the head: a choice
    return bytes.substr(0, looked_at).find('\0') != std::string_view::npos;
}

}  // namespace

std::optional<DecodedText> decode_text(const std::string& bytes, const std::optional<std::string>& encoding) {
    std::string_view rest = bytes;
    if (rest.starts_with("\xEF\xBB\xBF") && encoding.value_or("utf-8") == "utf-8")
        return DecodedText{with_own_line_ends(bytes.substr(3)), "UTF-8 with a byte order mark"};
    const bool little = rest.starts_with("\xFF\xFE"), big = rest.starts_with("\xFE\xFF");
    if ((little || big) && encoding.value_or("utf-16") == "utf-16")
        return DecodedText{with_own_line_ends(from_utf16(rest.substr(2), big)), "UTF-16 with a byte order mark"};
    const char order = utf16_order(rest);
    if (encoding == "utf-16" || (!encoding && order != 0))
        return DecodedText{with_own_line_ends(from_utf16(rest, order == 'b')), "UTF-16"};
    if (is_binary(rest)) return std::nullopt;
    if (encoding == "utf-8" || (!encoding && mesh::length_in_utf8(rest) == rest.size()))
        return DecodedText{with_own_line_ends(bytes), "UTF-8"};
    return DecodedText{with_own_line_ends(from_windows_1252(rest)), "Latin-1"};
}

}  // namespace palpate::identify
