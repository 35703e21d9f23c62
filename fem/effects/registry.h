#pragma once

#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "fem/effects/known_effect.h"

namespace palpate::fem {

/// All effects that are known to this program: those of built_in.h, then those that others add. Safe from several
/// threads.
class EffectRegistry {
public:
    static EffectRegistry& instance();

    /// @throws InvalidInput when the name is known already.
    void add(KnownEffect effect);
    /// The effect of that name; null when there is none. It stays where it is.
    const KnownEffect* find(const std::string& name) const;
    /// In the order in which they became known, a body's before those of measurements.
    std::vector<std::string> names() const;
    /// The physics of an effect. @throws InvalidInput for a name that is no effect of a body, a parameter that is
    /// missing, unknown, in another unit or out of range.
    Effects make(const EffectRecord& given) const;

private:
    EffectRegistry();
    const KnownEffect* find_unlocked(const std::string& name) const;
    const KnownEffect& of_body(const std::string& name) const;

    mutable std::mutex mutex_;
    std::deque<KnownEffect> effects_;  // which stay where they are when others come
};

}  // namespace palpate::fem
