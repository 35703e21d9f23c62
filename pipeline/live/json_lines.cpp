#include "pipeline/live/json_lines.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "mesh/errors.h"
#include "pipeline/live/json_reading.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

bool has_news(int descriptor) {
    pollfd one{descriptor, POLLIN, 0};
    return ::poll(&one, 1, 0) > 0;
}

/// @return bytes that were appended; 0: the other end is closed.
ssize_t append_from(int descriptor, std::string& text) {
    std::array<char, 65536> bytes{};
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count > 0) text.append(bytes.data(), static_cast<std::size_t>(count));
    return count;
}

/// A line that nothing ends is whole where nothing follows.
void end_line(std::string& text) {
    if (!text.empty() && text.back() != '\n') text += '\n';
}

class StandardInput : public ByteSource {
public:
    bool read(std::string& text) override {
        if (!has_news(STDIN_FILENO) || append_from(STDIN_FILENO, text) != 0) return true;
        end_line(text);
        return false;
    }
    void answer(const std::string&) override {}  // standard output tells
    std::string name() const override { return "standard input"; }
};

/// Owns a file descriptor.
class Descriptor {
public:
    explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { reset(); }
    void reset(int descriptor = -1) {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = descriptor;
    }
    int operator*() const { return descriptor_; }
    explicit operator bool() const { return descriptor_ >= 0; }

private:
    int descriptor_;
};

class UnixSocket : public ByteSource {
public:
    explicit UnixSocket(const fs::path& path) : path_(path) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        const std::string name = path.string();
        if (name.size() >= sizeof(address.sun_path))
            throw InvalidInput(fmt::format("{}: a socket's path has {} bytes at most; choose a shorter one", name,
                                           sizeof(address.sun_path) - 1));
        std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
        const auto* general = reinterpret_cast<const sockaddr*>(&address);
        const auto status = fs::symlink_status(path);
        if (fs::exists(status)) {
            if (!fs::is_socket(status))
                throw InvalidInput(fmt::format("{}: is there and is no socket; choose another name", name));
            const Descriptor other(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
            if (::connect(*other, general, sizeof(address)) == 0)
                throw InvalidInput(fmt::format("{}: another program listens there; choose another name", name));
            fs::remove(path);  // of a program that was killed
        }
        listener_.reset(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
        constexpr int waiting = 8;  // programs
        if (!listener_ || ::bind(*listener_, general, sizeof(address)) != 0 || ::listen(*listener_, waiting) != 0)
            throw IoError(fmt::format("{}: no socket can be made there: {}", name, std::strerror(errno)));
    }
    UnixSocket(const UnixSocket&) = delete;
    UnixSocket& operator=(const UnixSocket&) = delete;
    ~UnixSocket() override {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }

    bool read(std::string& text) override {
        if (has_ended_) client_.reset();  // what it sent has been answered
        has_ended_ = false;
        if (!client_ && has_news(*listener_)) client_.reset(::accept4(*listener_, nullptr, nullptr, SOCK_CLOEXEC));
        if (client_ && has_news(*client_) && append_from(*client_, text) <= 0) {
            end_line(text);
            has_ended_ = true;
        }
        return true;
    }
    void answer(const std::string& line) override {
        // One that has gone, or does not read what it is told, misses it.
        if (client_) (void)::send(*client_, (line + "\n").data(), line.size() + 1, MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    std::string name() const override { return path_.string(); }

private:
    fs::path path_;
    Descriptor listener_, client_;
    bool has_ended_ = false;  // the client sends no more
};

}  // namespace

std::unique_ptr<ByteSource> standard_input() { return std::make_unique<StandardInput>(); }
std::unique_ptr<ByteSource> unix_socket(const fs::path& path) { return std::make_unique<UnixSocket>(path); }

JsonLines::JsonLines(const identify::MeasurementSet& set, std::unique_ptr<ByteSource> source)
    : set_(set), source_(std::move(source)) {}

JsonLines::Arrived JsonLines::poll() {
    Arrived arrived;
    arrived.is_over = !source_->read(text_);
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
        const std::string line = text_.substr(0, end);
        text_.erase(0, end + 1);
        ++line_;
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        try {
            arrived.states.push_back(read_json_reading(line, set_, fmt::format("{}, line {}", name(), line_)));
        } catch (const InvalidInput& fault) {
            arrived.faults.emplace_back(fault.what());
        }
    }
    return arrived;
}

}  // namespace palpate::pipeline
