#include "pipeline/analysis/cost/machine_speed.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

namespace palpate::pipeline {
namespace {

// Of the machine of tests/bench/cost/RESULTS.md.
constexpr double seconds_to_factor = 0.0103, seconds_to_sort = 0.061;

template <class Work>
double seconds_of(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The least of a few: other programs only slow it down.
template <class Work>
double least_seconds_of(Work&& work) {
    constexpr int times = 3;
    double least = INFINITY;
    for (int k = 0; k < times; ++k) least = std::min(least, seconds_of(work));
    return least;
}

}  // namespace

double machine_speed() {
    constexpr Eigen::Index size = 768;
    const Eigen::MatrixXd A = Eigen::MatrixXd::Constant(size, size, 1) + size * Eigen::MatrixXd::Identity(size, size);
    Eigen::LLT<Eigen::MatrixXd> factor(size);
    const double to_factor = least_seconds_of([&] { factor.compute(A); });
    const double to_sort = least_seconds_of([] {
        constexpr int count = 1'000'000;
        std::mt19937 random(1);
        std::vector<unsigned> numbers(count);
        std::ranges::generate(numbers, random);
        std::ranges::sort(numbers);
    });
    return std::sqrt(seconds_to_factor / to_factor * seconds_to_sort / to_sort);
}

}  // namespace palpate::pipeline
