#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate::mesh {

/// Takes one number after the other out of a file that is text throughout, or text with binary stretches between.
class Numbers {
public:
    Numbers(std::string_view content, std::filesystem::path file) : content_(content), file_(std::move(file)) {}

    /// Numbers that follow are binary (in the machine's order of bytes), or words again.
    void set_binary(bool binary) { binary_ = binary; }

    /// A whole number of 4 or of 8 bytes, or a finite number of 8. @throws InvalidInput, `what` says what it should be.
    int next_int(std::string_view what);
    std::int64_t next_long(std::string_view what);
    double next_double(std::string_view what);
    /// How many things follow, of `least_bytes` or more each: a promise that the file cannot keep is refused.
    std::int64_t next_count(std::string_view what, std::int64_t least_bytes);

    /// The next word of the text; empty at the end.
    std::string_view next_word();
    /// The same, left where it is.
    std::string_view peek_word();
    /// The rest of the line.
    void skip_line();
    /// To just behind this text; false where there is none.
    bool skip_behind(std::string_view text);

    /// "body.msh, line 12", or "body.msh, byte 812" within a binary stretch.
    std::string where() const;

private:
    void skip_blanks();
    std::string_view bytes(std::size_t count);
    [[noreturn]] void fail_cut_off(std::string_view what) const;

    std::string_view content_;
    std::filesystem::path file_;
    std::size_t at_ = 0;
    int line_ = 1;
    bool binary_ = false;
};

}  // namespace palpate::mesh
