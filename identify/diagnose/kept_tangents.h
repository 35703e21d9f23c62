#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "identify/models/body_model.h"

namespace palpate::identify {

/// The factored tangents of a model in a problem's actions, made as they are asked for. Those of the first actions are
/// kept, as many as there is room for, whichever is asked for first; the others are made anew each time. Safe from
/// several threads that ask for different actions.
class KeptTangents {
public:
    static constexpr double usual_room = 0.5;  // [GB]
    explicit KeptTangents(std::size_t actions, double room = usual_room) : kept_(actions), room_(room) {}

    using Make = std::function<std::shared_ptr<const Tangent>()>;
    std::shared_ptr<const Tangent> get(int action, const Make& make);
    /// Null where it is not kept.
    const Tangent* kept(int action) const { return kept_[action].get(); }

private:
    std::vector<std::shared_ptr<const Tangent>> kept_;
    double room_;
};

}  // namespace palpate::identify
