#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// Where bytes come from while the program runs.
class ByteSource {
public:
    virtual ~ByteSource() = default;
    /// Appends what has come, without waiting for more; false: no more will come.
    virtual bool read(std::string& text) = 0;
    /// Tells whoever sent the last bytes, where that can be.
    virtual void answer(const std::string& line) = 0;
    virtual std::string name() const = 0;
};

std::unique_ptr<ByteSource> standard_input();
/// A Unix socket, at which programs connect one after the other. It is removed with the source.
/// @throws InvalidInput, IoError where there is something else, another program listens, or the path is too long.
std::unique_ptr<ByteSource> unix_socket(const std::filesystem::path& path);

/// Readings as lines of JSON (json_reading.h).
class JsonLines {
public:
    JsonLines(const identify::MeasurementSet& set, std::unique_ptr<ByteSource> source);

    /// What has come since the last look.
    struct Arrived {
        std::vector<identify::LoadState> states;
        std::vector<std::string> faults;  // of lines that are no readings
        bool is_over = false;
    };
    Arrived poll();
    void answer(const std::string& line) { source_->answer(line); }
    std::string name() const { return source_->name(); }

private:
    const identify::MeasurementSet& set_;
    std::unique_ptr<ByteSource> source_;
    std::string text_;
    int line_ = 0;
};

}  // namespace palpate::pipeline
