#include "fem/effects/material/anisotropy.h"

#include <cassert>

#include "mesh/errors.h"

namespace palpate::fem {

Anisotropy::Anisotropy(std::vector<Fibre> fibres) : fibres_(std::move(fibres)) {
    for (Fibre& fibre : fibres_) {
        assert(fibre.n.norm() > 0);
        fibre.n.normalize();
    }
}

MaterialTerms Anisotropy::terms(const Vec3& /*X*/, const Mat3& F, bool with_second) const {
    MaterialTerms result;
    for (const auto& [k, n] : fibres_) {
        // d (n.E n) / dF = F n n^T
        const Vec3 along = F * n;
        const double strain = (along.squaredNorm() - 1) / 2;
        const Mat3 by_F = along * n.transpose();
        result.w += k / 2 * strain * strain;
        result.first += k * strain * by_F;
        if (!with_second) continue;
        for (int c = 0; c < 3; ++c) {
            for (int d = 0; d < 3; ++d) {
                const double factor = k * (along(c) * along(d) + (c == d ? strain : 0));
                result.second.block<3, 3>(Eigen::Index{3} * c, Eigen::Index{3} * d) += factor * n * n.transpose();
            }
        }
    }
    return result;
}

KnownEffect known_anisotropy() {
    return {"anisotropy",
            {{"k", "1"},
             {"nx", "1"},
             {"ny", "1"},
             {"nz", "1"},
             optional_parameter("k2", "1"),
             optional_parameter("n2x", "1"),
             optional_parameter("n2y", "1"),
             optional_parameter("n2z", "1")},
            [](const EffectNumbers& numbers) -> Effects {
                std::vector<Fibre> fibres{{numbers["k"], numbers.direction("n")}};
                int given = 0;
                for (const char* name : {"k2", "n2x", "n2y", "n2z"}) given += numbers.has(name) ? 1 : 0;
                if (given != 0 && given != 4)
                    throw InvalidInput("a second family of fibres needs all of k2, n2x, n2y and n2z");
                if (given == 4) fibres.push_back({numbers["k2"], numbers.direction("n2")});
                return {.material = {std::make_shared<Anisotropy>(std::move(fibres))}};
            }};
}

}  // namespace palpate::fem
