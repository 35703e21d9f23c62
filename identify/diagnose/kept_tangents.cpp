#include "identify/diagnose/kept_tangents.h"

namespace palpate::identify {

std::shared_ptr<const Tangent> KeptTangents::get(int action, const Make& make) {
    auto& kept = kept_[action];
    if (kept) return kept;
    auto made = make();
    // Those of one body are alike.
    if ((action + 1) * made->gigabytes() <= room_) kept = made;
    return made;
}

}  // namespace palpate::identify
