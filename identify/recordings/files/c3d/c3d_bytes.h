#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate::identify {

/// How the machine that wrote a C3D file writes numbers.
enum class C3dProcessor { intel, dec, mips };

/// The bytes of a C3D file as numbers. @throws InvalidInput where they end too early.
class C3dBytes {
public:
    C3dBytes(const std::string& bytes, const std::filesystem::path& file);

    std::size_t size() const { return bytes_.size(); }
    C3dProcessor processor() const { return processor_; }
    std::size_t parameters_at() const { return parameters_at_; }
    std::string name() const { return file_.filename().string(); }

    int byte(std::size_t at) const;     // 0 to 255
    int integer(std::size_t at) const;  // of 16 bits, with a sign
    int word(std::size_t at) const { return integer(at) & 0xFFFF; }
    float real(std::size_t at) const;
    std::string text(std::size_t at, std::size_t size) const;
    /// @throws InvalidInput where so many bytes are not there.
    void require(std::size_t at, std::size_t size) const;

private:
    std::uint32_t little(std::size_t at, int bytes) const;

    const std::string& bytes_;
    std::filesystem::path file_;
    std::size_t parameters_at_ = 0;
    C3dProcessor processor_ = C3dProcessor::intel;
};

}  // namespace palpate::identify
