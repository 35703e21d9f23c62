#pragma once

#include <memory>
#include <mutex>

namespace palpate::fem {

/// Something made when it is first asked for, by whichever thread.
template <class Value>
class Lazy {
public:
    template <class Make>
    const Value& get(Make&& make) const {
        std::call_once(once_, [&] { value_ = std::make_unique<const Value>(make()); });
        return *value_;
    }

private:
    mutable std::once_flag once_;
    mutable std::unique_ptr<const Value> value_;
};

}  // namespace palpate::fem
