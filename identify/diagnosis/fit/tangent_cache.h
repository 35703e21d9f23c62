#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "identify/models/body_model.h"

namespace palpate::identify {

/// The factored tangents of a model in a problem's actions, made as they are asked for. Those of the first actions are
/// kept, as many as there is room for, whichever is asked for first; the others are made anew each time. Safe from
/// several threads that ask for different actions.
class TangentCache {
public:
    static constexpr double default_capacity = 0.5;  // [GB]; a fit has two at a time, more saves factorisations
    explicit TangentCache(std::size_t actions, double capacity = default_capacity)
        : kept_(actions), capacity_(capacity) {}

    using Make = std::function<std::shared_ptr<const Tangent>()>;
    std::shared_ptr<const Tangent> get(int action, const Make& make);
    /// Null where it is not kept.
    const Tangent* kept(int action) const { return kept_[action].get(); }

private:
    std::vector<std::shared_ptr<const Tangent>> kept_;
    double capacity_;
};

}  // namespace palpate::identify
