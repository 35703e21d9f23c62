#include "skeleton/construction/properties/masses.h"

namespace palpate::skeleton {

void set_masses(const TetGraph& graph, const std::vector<int>& owner, double density, std::vector<Sphere>& spheres) {
    for (Sphere& sphere : spheres) {
        sphere.mass = 0;
        sphere.inertia.setZero();
        sphere.cell = 0;
    }
    for (int t = 0; t < graph.size(); ++t) {
        Sphere& sphere = spheres[owner[t]];
        const double mass = density * graph.volumes(t);
        // Over a tetrahedron with corners x_i the mean of x x^T is (sum_i x_i x_i^T + s s^T) / 20, s = sum_i x_i.
        Vec3 s = Vec3::Zero();
        Mat3 second = Mat3::Zero();
        for (int c = 0; c < 4; ++c) {
            const Vec3 x = graph.node(t, c) - sphere.center;
            s += x;
            second += x * x.transpose();
        }
        second = mass / 20 * (second + s * s.transpose());
        sphere.mass += mass;
        sphere.cell += graph.volumes(t);
        sphere.inertia += second.trace() * Mat3::Identity() - second;
    }
}

}  // namespace palpate::skeleton
