#pragma once

#include <cstdint>
#include <vector>

#include "identify/inference/priors/informative_prior.h"
#include "skeleton/model/model.h"

namespace palpate::identify {

/// Which links share a stiffness multiplier.
enum class Scope { uniform, zones, links };

enum class Method {
    tempered,    // particles from a Gaussian near the fit, tempered to the posterior; measured positions
    burion2008,  // Algorithm 1 as printed, in log weights; net forces and torques
};

/// What measurements are weighed by.
enum class Domain {
    by_method,  // tempered: position, burion2008: force
    position,   // the model's equilibria next to the measured markers
    force,      // the net forces that the model leaves in the measured configurations
};

/// Which law of equilibrium explains the measurements: told, or chosen by fit.
enum class LawChoice { automatic, linear, large_rotation };

struct IdentifyOptions {
    Scope scope = Scope::links;
    Method method = Method::tempered;
    Domain domain = Domain::by_method;
    LawChoice law = LawChoice::automatic;
    int particles = 0;        // 0: 200 (tempered), 600 (burion2008)
    int iterations = 20;      // burion2008: K
    double search_low = 0.1;  // burion2008: box V, as multiples of the model's own stiffness
    double search_high = 10.0;
    std::vector<skeleton::Stiffness> fixed;     // kinds that are known: they stay as the model has them
    std::vector<InformativePrior> priors = {};  // of stiffness, from other specimens
    std::uint64_t seed = 1;
    int threads = 1;
    void validate() const;  // @throws InvalidInput naming option, value, bound
};

}  // namespace palpate::identify
