#include "identify/recordings/files/c3d/c3d_bytes.h"

#include <fmt/format.h>

#include <bit>

#include "mesh/errors.h"

namespace palpate::identify {

C3dBytes::C3dBytes(const std::string& bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {
    constexpr std::size_t block = 512;   // [bytes], of the format
    constexpr int first_processor = 83;  // intel is 84
    parameters_at_ = block * (static_cast<std::size_t>(byte(0)) - 1);
    if (byte(0) == 0)
        throw InvalidInput(
            fmt::format("{}: its header says that the parameters are in block 0; blocks count from 1. The "
                        "file is broken: export it again.",
                        name()));
    const int processor = byte(parameters_at_ + 3) - first_processor;
    if (processor < 1 || processor > 3)
        throw InvalidInput(
            fmt::format("{}: its kind of processor is {}; 84 (Intel), 85 (DEC) and 86 (MIPS) are allowed. The "
                        "file is broken: export it again.",
                        name(), processor + first_processor));
    processor_ = static_cast<C3dProcessor>(processor - 1);
}

void C3dBytes::require(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
        throw InvalidInput(
            fmt::format("{}: {} bytes are needed from byte {} on, but the file ends at {}. It is cut off: "
                        "export it again.",
                        name(), size, at, bytes_.size()));
}

int C3dBytes::byte(std::size_t at) const {
    require(at, 1);
    return static_cast<unsigned char>(bytes_[at]);
}

std::uint32_t C3dBytes::little(std::size_t at, int bytes) const {
    std::uint32_t value = 0;
    for (int i = bytes - 1; i >= 0; --i)
        value = value << 8 | static_cast<unsigned char>(bytes_[at + static_cast<std::size_t>(i)]);
    return value;
}

int C3dBytes::integer(std::size_t at) const {
    require(at, 2);
    std::uint32_t value = little(at, 2);
    if (processor_ == C3dProcessor::mips) value = (value & 0xFF) << 8 | value >> 8;
    return static_cast<std::int16_t>(value);
}

float C3dBytes::real(std::size_t at) const {
    require(at, 4);
    const std::uint32_t bits = little(at, 4);
    switch (processor_) {
        case C3dProcessor::intel:
            return std::bit_cast<float>(bits);
        case C3dProcessor::mips:
            return std::bit_cast<float>(bits << 24 | (bits & 0xFF00) << 8 | (bits >> 8 & 0xFF00) | bits >> 24);
        case C3dProcessor::dec:
        default:
            // VAX F: the halves are exchanged, and the exponent is 2 more.
            return std::bit_cast<float>(bits << 16 | bits >> 16) / 4;
    }
}

std::string C3dBytes::text(std::size_t at, std::size_t size) const {
    require(at, size);
    return bytes_.substr(at, size);
}

}  // namespace palpate::identify
