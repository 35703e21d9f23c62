#include "identify/diagnosis/fit/tangent_cache.h"

namespace palpate::identify {

std::shared_ptr<const Tangent> TangentCache::get(int action, const Make& make) {
    auto& kept = kept_[action];
    if (kept) return kept;
    auto made = make();
    // Those of one body are alike.
    if ((action + 1) * made->gigabytes() <= capacity_) kept = made;
    return made;
}

}  // namespace palpate::identify
