#pragma once

#include <chrono>
#include <cmath>

#include "identify/identify.h"
#include "identify/inference/domains/position/position_domain.h"
#include "identify/numerics/random.h"
#include "samples/lattice.h"

namespace palpate::bench {

using namespace identify;

class Watch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One of the paper's experiments, measured with noise.
struct Trial {
    samples::Experiment experiment;
    Scope scope;
    MeasurementSet set;
    std::vector<double> truth;  // of each parameter: kE and kF of each zone

    Trial(const samples::Experiment& made, double noise_share, std::uint64_t seed)
        : experiment(made), scope(made.elongation.size() > 1 ? Scope::zones : Scope::uniform), set(made.set) {
        constexpr double spacing = 40;
        for (std::size_t zone = 0; zone < made.elongation.size(); ++zone) {
            truth.push_back(made.elongation[zone]);
            truth.push_back(made.flexion[zone]);
        }
        if (noise_share == 0) return;
        set.position_noise = noise_share * spacing;
        for (std::size_t s = 0; s < set.states.size(); ++s) {
            RandomStream random(seed, 1000, s);
            for (Reading& reading : set.states[s].readings) {
                reading.position += *set.position_noise * random.normals(3);
            }
        }
    }

    IdentifyOptions options(Method method, Domain domain, std::uint64_t seed) const {
        IdentifyOptions how;
        how.scope = scope;
        how.method = method;
        how.domain = domain;
        how.law = LawChoice::large_rotation;
        how.fixed = {skeleton::Stiffness::torsion};
        how.seed = seed;
        how.search_low = 0.05;
        how.search_high = 2;
        if (method == Method::burion2008) how.particles = scope == Scope::zones ? 900 : 600;
        return how;
    }

    /// Errors of markers by log multipliers, for other people's optimisers.
    PositionDomain domain() const {
        PositionDomain result(experiment.start, skeleton::EquilibriumLaw::large_rotation,
                              group_stiffness(experiment.start, scope, {skeleton::Stiffness::torsion}),
                              collect_readings(experiment.start, set), 1);
        result.set_model_error(0);
        return result;
    }

    double error_of(const Eigen::VectorXd& stiffness) const {
        double sum = 0;
        for (std::size_t p = 0; p < truth.size(); ++p) {
            sum += std::pow(stiffness[static_cast<Eigen::Index>(p)] / truth[p] - 1, 2);
        }
        return std::sqrt(sum / static_cast<double>(truth.size()));
    }
};

}  // namespace palpate::bench
