// What a second mesh says of a reference's error, against what a much finer one says.

#include "pipeline/analysis/accuracy.h"
#include "pipeline/case/settings/overrides.h"
#include "pipeline/case/subject/subject_body.h"

#include <gtest/gtest.h>

#include "fem/elements/patch_load.h"
#include "fem/interpolation/interpolation.h"
#include "mesh/formats/surface/read_surface.h"
#include "pipeline/body/body.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/synthesis/probing/probing.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

struct AccuracyOfAReference : ::testing::Test {
    static constexpr double edge = 6;  // [mm]

    Subject subject() const {
        mesh::write_surface(folder / "bar.stl", mesh::make_box({0, 0, 0}, {60, 16, 12}, {6, 2, 2}));
        CaseOverrides overrides;
        overrides.set("volume.linear_elements", linear_elements ? "true" : "false");
        Subject subject = read_subject(read_case(folder / "bar.stl", overrides));
        // a clamp that every mesh holds alike: what else differs between meshes would hide what elements do
        subject.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(1e-6, 17, 13)}};
        return subject;
    }
    fem::ElasticBody body_with(const Subject& subject, double edge_length) const {
        const MeshedBody body = make_body(subject, {.edge_length = edge_length, .linear_elements = linear_elements});
        return {body.volume, subject.material, mesh::contains(subject.supports, body.volume.nodes)};
    }

    /// Estimated and true, by elements two fifths as long.
    std::pair<double, double> errors() const {
        Subject subject = this->subject();
        subject.material.poisson = 0.3;
        const fem::ElasticBody body = body_with(subject, edge), fine = body_with(subject, 0.4 * edge);
        const ProbedBody probed = probe_body(body, subject.surface, subject.supports, {.probes = 6, .markers = 40}, 1);
        const auto accuracy = estimate_accuracy(subject, body, edge, probed.set);
        EXPECT_TRUE(accuracy);
        Points markers(std::ssize(probed.set.markers), 3);
        for (Eigen::Index m = 0; m < markers.rows(); ++m) markers.row(m) = probed.set.markers[m].rest;
        double off = 0, size = 0;
        for (const identify::LoadState& state : probed.set.states) {
            if (state.contacts.empty()) continue;
            const auto seen = [&](const fem::ElasticBody& one) -> Points {
                const Eigen::MatrixXd u = one.solve(fem::patch_loads(one.mesh(), state.contacts, 1));
                const Eigen::Map<const Points> of_nodes(u.data(), u.rows() / 3, 3);
                return fem::interpolation(one.mesh(), markers) * of_nodes;
            };
            off += (seen(body) - seen(fine)).squaredNorm();
            size += seen(fine).squaredNorm();
        }
        return {accuracy ? accuracy->relative : 0, std::sqrt(off / size)};
    }

    bool linear_elements = false;
    const TemporaryFolder folder;
};

// Where the error falls more slowly with the edge than is assumed, the estimate is too low: half of the truth with
// these quadratic elements, three quarters with linear ones. Another mesher's meshes move either share.

TEST_F(AccuracyOfAReference, IsAboutHalfOfTheTruth) {
    const auto [estimated, truth] = errors();
    EXPECT_NEAR(estimated / truth, 0.46, 0.1);
    EXPECT_LT(truth, 0.022);
}

TEST_F(AccuracyOfAReference, TellsLinearElementsFromQuadraticOnes) {
    const double quadratic = errors().first;
    linear_elements = true;
    const auto [estimated, truth] = errors();
    EXPECT_NEAR(estimated / quadratic, 21, 2);
    EXPECT_NEAR(estimated / truth, 0.76, 0.1);
}

TEST_F(AccuracyOfAReference, IsNotGuessedForAMeshThatIsGiven) {
    Subject subject = this->subject();
    const fem::ElasticBody body = body_with(subject, edge);
    const ProbedBody probed = probe_body(body, subject.surface, subject.supports, {.probes = 2, .markers = 10}, 1);
    subject.volume = body.mesh();
    EXPECT_FALSE(estimate_accuracy(subject, body, edge, probed.set));
}

}  // namespace
}  // namespace palpate::pipeline
