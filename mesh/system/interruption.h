#pragma once

#include <functional>

namespace palpate {

/// Whether long work is to go on, asked now and then in the middle of it, also where there is no progress to report.
/// Who embeds the libraries sets it for the thread that calls them; it throws what is to end the work.
class Interruption {
public:
    /// For as long as this lives, in this thread. @pre `ask` outlives it.
    explicit Interruption(const std::function<void()>& ask) : before_(asked()) { asked() = &ask; }
    ~Interruption() { asked() = before_; }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// In the middle of long work. Does nothing in threads that none was set for. @throws what the question throws.
    static void ask() {
        if (const auto* question = asked()) (*question)();
    }

private:
    static const std::function<void()>*& asked() {
        static thread_local const std::function<void()>* in_this_thread = nullptr;
        return in_this_thread;
    }
    const std::function<void()>* before_;
};

}  // namespace palpate
