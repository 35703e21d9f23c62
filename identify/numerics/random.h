#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace palpate::identify {

/// A stream of random numbers that its key alone decides, (seed, step, item): items drawn by several threads get
/// the same numbers whoever draws first. [SplitMix64: Steele, Lea, Flood 2014]
class RandomStream {
public:
    RandomStream(std::uint64_t seed, std::uint64_t step, std::uint64_t item);

    double uniform();                // [0, 1)
    double normal();                 // mean 0, sd 1
    Eigen::VectorXd normals(int n);  // (n)

private:
    std::uint64_t next();
    std::uint64_t state_;
};

}  // namespace palpate::identify
