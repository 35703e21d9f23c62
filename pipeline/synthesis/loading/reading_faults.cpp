#include "pipeline/synthesis/loading/reading_faults.h"

#include <algorithm>
#include <bit>

#include "identify/numerics/random.h"

namespace palpate::pipeline {
namespace {

using identify::RandomStream;

enum class Purpose : std::uint64_t { noise, outliers, missing, unlabelled };

RandomStream stream(std::uint64_t seed, const identify::LoadState& state, Purpose purpose) {
    const auto probe = static_cast<std::uint64_t>(state.probe);
    return {seed, 4 * probe + static_cast<std::uint64_t>(purpose), std::bit_cast<std::uint64_t>(state.time)};
}

}  // namespace

std::vector<identify::Reading> read_markers(const identify::LoadState& state, const Points& positions,
                                            const ReadingFaults& faults, std::uint64_t seed) {
    RandomStream noisy = stream(seed, state, Purpose::noise), wild = stream(seed, state, Purpose::outliers),
                 lost = stream(seed, state, Purpose::missing), nameless = stream(seed, state, Purpose::unlabelled);
    struct Nameless {
        double order;
        identify::Reading reading;
    };
    std::vector<identify::Reading> readings;
    std::vector<Nameless> without_label;
    for (int m = 0; m < static_cast<int>(positions.rows()); ++m) {
        identify::Reading reading{m, positions.row(m).transpose()};
        reading.position += faults.noise * noisy.normals(3);
        const Vec3 off = faults.outlier_width * faults.noise * wild.normals(3);
        if (wild.uniform() < faults.outlier_share) reading.position += off;
        const bool is_missing = lost.uniform() < faults.missing;
        const bool has_label = nameless.uniform() >= faults.unlabelled;
        const double order = nameless.uniform();
        if (is_missing) continue;
        if (has_label) {
            readings.push_back(reading);
        } else {
            reading.marker = -1;
            without_label.push_back({order, reading});
        }
    }
    std::ranges::sort(without_label, {}, &Nameless::order);
    for (const Nameless& one : without_label) readings.push_back(one.reading);
    return readings;
}

void add_reaction_noise(const identify::LoadState& state, double noise, std::uint64_t seed,
                        identify::ReactionReading& reading) {
    // Beyond the streams of all probes' markers.
    constexpr std::uint64_t load_cells = 1ULL << 40U;
    RandomStream noisy(seed, load_cells + static_cast<std::uint64_t>(state.probe),
                       std::bit_cast<std::uint64_t>(state.time));
    reading.force += noise * noisy.normals(3);
}

}  // namespace palpate::pipeline
