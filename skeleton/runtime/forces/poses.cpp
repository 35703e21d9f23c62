#include "skeleton/runtime/forces/poses.h"

#include <Eigen/Geometry>

#include "skeleton/runtime/kernels/tables.h"

namespace palpate::runtime {

void Poses::assign(const double* pose) {
    for (std::size_t i = 0; i < x.size(); ++i, pose += row_length) {
        x[i] = Eigen::Map<const Vec3>(pose);
        R[i] = Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(pose + 4)).toRotationMatrix();
    }
}

}  // namespace palpate::runtime
