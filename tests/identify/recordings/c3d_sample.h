#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::identify {

/// Writes C3D files as the format's description tells, in the way of each kind of processor.
class C3dSample {
public:
    enum class Processor { intel = 84, dec = 85, mips = 86 };
    explicit C3dSample(Processor processor = Processor::intel) : processor_(processor) {}

    // What the file holds: two points in three frames, of which the second is not seen in frame 2; two channels,
    // sampled twice a frame.
    bool has_reals = true;
    bool has_analogs = true;
    std::string unit = "m";
    int first_frame = 1, frames = 3;

    std::string bytes() const {
        std::string parameters = all_parameters();
        const int blocks = static_cast<int>(parameters.size() + 511) / 512;
        parameters.resize(static_cast<std::size_t>(blocks) * 512);
        parameters[2] = static_cast<char>(blocks);
        // The place of the data is known now: it stands in the header and in POINT:DATA_START.
        const int start = 2 + blocks;
        std::string file = header(start) + parameters;
        const std::size_t at = file.find("DATA_START") + 10 + 2 + 2;
        file.replace(at, 2, integer(start));
        for (int f = 0; f < frames; ++f) file += frame(f);
        file.resize((file.size() + 511) / 512 * 512);
        return file;
    }

    std::string integer(int value) const {
        const auto bits = static_cast<std::uint16_t>(value);
        std::string bytes{static_cast<char>(bits & 0xFF), static_cast<char>(bits >> 8)};
        if (processor_ == Processor::mips) std::swap(bytes[0], bytes[1]);
        return bytes;
    }

    std::string real(float value) const {
        if (processor_ == Processor::dec) value *= 4;
        const auto bits = std::bit_cast<std::uint32_t>(value);
        std::string bytes;
        for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xFF);
        if (processor_ == Processor::mips) return {bytes.rbegin(), bytes.rend()};
        if (processor_ == Processor::dec) return {bytes[2], bytes[3], bytes[0], bytes[1]};
        return bytes;
    }

private:
    static constexpr float scale = 0.5F;  // of integers

    std::string header(int start) const {
        std::string head(512, '\0');
        const auto put = [&](std::size_t at, const std::string& bytes) { head.replace(at, bytes.size(), bytes); };
        head[0] = 2;
        head[1] = 0x50;
        put(2, integer(2));
        put(4, integer(has_analogs ? 4 : 0));
        put(6, integer(first_frame));
        put(8, integer(first_frame + frames - 1));
        put(12, real(has_reals ? -scale : scale));
        put(16, integer(start));
        put(18, integer(has_analogs ? 2 : 0));
        put(20, real(100));
        return head;
    }

    std::string all_parameters() const {
        std::string text{'\0', '\0', '\0', static_cast<char>(processor_)};
        text += group(1, "POINT") + group(2, "ANALOG") + group(3, "EVENT");
        text += parameter(1, "USED", 2, {}, integer(2));
        text += parameter(1, "SCALE", 4, {}, real(has_reals ? -scale : scale));
        text += parameter(1, "RATE", 4, {}, real(100));
        text += parameter(1, "FRAMES", 2, {}, integer(frames));
        text += parameter(1, "DATA_START", 2, {}, integer(0));
        text += parameter(1, "LABELS", -1, {4, 2}, "BaseTip ");
        text += parameter(1, "UNITS", -1, {static_cast<int>(unit.size())}, unit);
        text += parameter(2, "USED", 2, {}, integer(has_analogs ? 2 : 0));
        text += parameter(2, "LABELS", -1, {2, 2}, "FzV ");
        text += parameter(2, "UNITS", -1, {2, 2}, "kNV ");
        text += parameter(2, "SCALE", 4, {2}, real(0.25F) + real(1));
        text += parameter(2, "OFFSET", 2, {2}, integer(4) + integer(0));
        text += parameter(2, "GEN_SCALE", 4, {}, real(2));
        text += parameter(3, "USED", 2, {}, integer(1));
        text += parameter(3, "LABELS", -1, {5, 1}, "Touch");
        text += parameter(3, "TIMES", 4, {2, 1}, real(0) + real(0.02F));
        return text + std::string(2, '\0');
    }

    std::string group(int id, const std::string& name) const {
        return std::string{static_cast<char>(name.size()), static_cast<char>(-id)} + name + integer(3) + '\0';
    }

    std::string parameter(int group, const std::string& name, int type, const std::vector<int>& dimensions,
                          const std::string& data) const {
        std::string body{static_cast<char>(type), static_cast<char>(dimensions.size())};
        for (const int size : dimensions) body += static_cast<char>(size);
        body += data + '\0';
        return std::string{static_cast<char>(name.size()), static_cast<char>(group)} + name +
               integer(static_cast<int>(body.size()) + 2) + body;
    }

    std::string number(int value) const { return has_reals ? real(static_cast<float>(value)) : integer(value); }

    /// Point p in frame f is at (10 p + f, 2, 3); channel c is 10 c + 2 f + s before its offset.
    std::string frame(int f) const {
        std::string bytes;
        for (int p = 0; p < 2; ++p)
            bytes += number(10 * p + f) + number(2) + number(3) + number(p == 1 && f == 1 ? -1 : 0);
        for (int s = 0; s < (has_analogs ? 2 : 0); ++s)
            for (int c = 0; c < 2; ++c) bytes += number(10 * c + 2 * f + s);
        return bytes;
    }

    Processor processor_;
};

}  // namespace palpate::identify
