#pragma once

#include "identify/models/body_geometry.h"
#include "identify/models/body_observation.h"
#include "identify/models/body_statics.h"

namespace palpate::identify {

/// A model of a body, as identification, comparison and diagnosis see it: they do not know whether it is made of finite
/// elements or of spheres and links.
class BodyModel : public BodyStatics, public BodyObservation, public BodyGeometry {
public:
    ~BodyModel() override = default;
};

}  // namespace palpate::identify
