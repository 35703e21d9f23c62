#include "samples/organ.h"

#include <cmath>

namespace palpate::samples {

mesh::Surface make_organ() {
    mesh::Surface organ = mesh::make_sphere(Vec3::Zero(), 1.0, 4);
    for (Eigen::Index v = 0; v < organ.vertices.rows(); ++v) {
        const Vec3 p = organ.vertices.row(v).transpose();
        const double thin = 1.0 - 0.45 * (p.x() + 1) / 2;  // thinner towards +x
        const double dent = 1.0 - 0.28 * std::exp(-6.0 * (p - Vec3(0.1, -0.9, -0.3)).squaredNorm());
        Vec3 q = dent * Vec3(90 * p.x(), 62 * thin * p.y(), 48 * thin * p.z());
        q.z() += 0.0022 * q.x() * q.x();  // bent along x
        organ.vertices.row(v) = q.transpose();
    }
    return organ;
}

}  // namespace palpate::samples
