#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mesh/types.h"

namespace palpate::identify {

/// Takes the frame of a recording to that of the mesh: x = scale R y + t.
struct RigidMotion {
    Mat3 R = Mat3::Identity();
    Vec3 t = Vec3::Zero();  // [mm]
    double scale = 1;

    Vec3 operator()(const Vec3& y) const { return scale * (R * y) + t; }
    Points operator()(const Points& y) const;  // (n x 3)
};

/// A motion that was fitted, and how well it is known.
struct Registration {
    RigidMotion motion;
    double rms = 0, largest = 0;                 // distances that are left [mm]
    double rotation_sd = 0, translation_sd = 0;  // [rad] about the worst axis; [mm] of the points' centre
    int points = 0;
    std::vector<std::string> notes;  // what is not determined, mirrored, or in another unit
};

/// From points whose counterparts are known (n x 3 both): least squares by singular values [Umeyama, IEEE PAMI 13
/// (1991)], uncertainty from the Gauss-Newton Hessian of the squared distances with their own mean square over 3n - 6
/// as variance. Of two points, or of some on a line, the turn about the line is the least that takes one line to the
/// other, and a note says so.
/// @param with_scale fits the scale too
/// @throws InvalidInput for fewer than two points.
Registration fit_counterparts(const Points& recorded, const Points& wanted, bool with_scale = false);

/// The same for points in a plane: turned about z only; z is left.
Registration fit_counterparts_in_plane(const Points& recorded, const Points& wanted);

/// The turn is known, the shift is the mean's: from one point on.
Registration fit_shift(const Points& recorded, const Points& wanted, const Mat3& R);

/// Each of `points` [mm], what a least-squares motion of these leaves of the mirrored ones over what it leaves as they
/// are: far below 1 where the recording's frame is left-handed. 1 for points in a plane.
double mirrored_share(const Points& recorded, const Points& wanted);

/// "Lengths in the recording are 1000 times those of the mesh: ..." where a ratio of lengths is that of two units;
/// else "". @param ratio of a length in the recording to the same of the mesh
std::string slip_of_units(double ratio);

}  // namespace palpate::identify
