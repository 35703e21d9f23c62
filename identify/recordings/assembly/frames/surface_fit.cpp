#include "identify/recordings/assembly/frames/surface_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mesh/errors.h"
#include "mesh/geometry/sampling.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int most_points = 150;  // of the search; all of them count at the end
// The search is a choice of cost: turns that are spread evenly, of which the best after a few steps are followed to the
// end. More take longer; less miss the pose of a body that looks alike from several sides.
constexpr int even_turns = 72, kept_poses = 8;
constexpr int search_steps = 12, last_steps = 60;
constexpr double cut = 3;              // medians of the distance, beyond which a point pulls no more
constexpr double undetermined = 1e-4;  // of the stiffest direction, turns measured at the surface's size
constexpr double as_good = 1.3;        // times the best rms: another pose that cannot be told from it
constexpr double mirrored = 0.5;       // times it: the mirrored points fit, and these do not

/// Points against a surface.
class SurfaceFit {
public:
    SurfaceFit(const mesh::Surface& surface, double stand_off)
        : tree_(surface), normals_(mesh::area_vectors(surface)), stand_off_(stand_off) {
        normals_.rowwise().normalize();
        const mesh::Box box = mesh::bounding_box(surface.vertices);
        size_ = box.diagonal() / 2;
    }

    struct System {
        Matrix6 H = Matrix6::Zero();
        Vector6 g = Vector6::Zero();
        Eigen::VectorXd distances;  // signed, from where they should be [mm]
        Vec3 centre = Vec3::Zero();
    };

    /// Distances along the normals at the moved points, and how a small turn (times the size) and shift alters them.
    System linearised(const Points& moved) const {
        System system;
        const auto n = moved.rows();
        system.centre = moved.colwise().mean().transpose();
        system.distances.resize(n);
        Eigen::Matrix<double, 6, Eigen::Dynamic> slopes(6, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Vec3 p = moved.row(i).transpose();
            const mesh::SurfacePoint near = tree_.closest(p);
            const Vec3 face = normals_.row(near.triangle).transpose(), off = p - near.position;
            const double side = off.dot(face) < 0 ? -1 : 1;
            // beside an edge the way to the surface is not the face's normal
            const Vec3 normal = near.distance > 1e-9 * size_ ? Vec3(side * off / near.distance) : face;
            system.distances[i] = side * near.distance - stand_off_;
            slopes.col(i) << (p - system.centre).cross(normal) / size_, normal;
        }
        const double limit = cut * std::max(median_of(system.distances.cwiseAbs()), 1e-9 * size_);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double weight = std::min(1.0, limit / std::max(std::abs(system.distances[i]), 1e-300));
            system.H += weight * slopes.col(i) * slopes.col(i).transpose();
            system.g += weight * slopes.col(i) * system.distances[i];
        }
        return system;
    }

    /// Steps until they are small.
    RigidMotion approached(const Points& points, RigidMotion pose, int most) const {
        for (int step = 0; step < most; ++step) {
            const System system = linearised(pose(points));
            Matrix6 H = system.H;
            H.diagonal().array() += 1e-6 * H.trace() / 6;  // along what is not determined nothing moves
            const Vector6 move = -H.ldlt().solve(system.g);
            if (!move.allFinite()) break;
            const Vec3 turn = move.head<3>() / size_;
            const Mat3 dR = Eigen::AngleAxisd(std::min(turn.norm(), 0.5),
                                              turn.norm() > 0 ? turn.normalized().eval() : Vec3(Vec3::UnitX()))
                                .toRotationMatrix();
            pose.R = dR * pose.R;
            pose.t = dR * (pose.t - system.centre) + system.centre + move.tail<3>();
            if (move.norm() < 1e-9 * size_) break;
        }
        pose.R = Eigen::Quaterniond(pose.R).normalized().toRotationMatrix();
        return pose;
    }

    double rms(const Points& points, const RigidMotion& pose) const {
        const Eigen::VectorXd d = linearised(pose(points)).distances;
        return std::sqrt(d.squaredNorm() / static_cast<double>(d.size()));
    }

    double size() const { return size_; }

private:
    static double median_of(const Eigen::VectorXd& values) {
        return mesh::upper_median(std::vector(values.begin(), values.end()));
    }

    mesh::SurfaceTree tree_;
    Points normals_;
    double stand_off_, size_ = 0;
};

/// Principal axes, a column each, right-handed.
Mat3 axes_of(const Points& points) {
    const Points about = points.rowwise() - points.colwise().mean();
    const Mat3 C = about.transpose() * about;
    Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(C).eigenvectors();
    if (axes.determinant() < 0) axes.col(0) *= -1;
    return axes;
}

/// The 24 turns of a cube.
std::vector<Mat3> turns_of_a_cube() {
    std::vector<Mat3> turns;
    turns.reserve(24);
    int order[3]{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Mat3 turn = Mat3::Zero();
            for (int i = 0; i < 3; ++i) turn(order[i], i) = (signs >> i & 1) != 0 ? -1 : 1;
            if (turn.determinant() > 0) turns.push_back(turn);
        }
    } while (std::next_permutation(order, order + 3));
    return turns;
}

std::vector<Mat3> spread_turns(int count) {
    constexpr double phi = std::numbers::sqrt2, psi = 1.533751168755204288118041;  // psi^4 = psi + 4
    std::vector<Mat3> turns;
    turns.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double s = i + 0.5, t = s / count, d = 2 * std::numbers::pi * s;
        const double r = std::sqrt(t), R = std::sqrt(1 - t), a = d / phi, b = d / psi;
        turns.push_back(
            Eigen::Quaterniond(R * std::cos(b), r * std::sin(a), r * std::cos(a), R * std::sin(b)).toRotationMatrix());
    }
    return turns;
}

struct Pose {
    RigidMotion motion;
    double rms = 0;
};

/// Poses from everywhere, the best first.
std::vector<Pose> searched(const SurfaceFit& fit, const Points& points, const mesh::Surface& surface) {
    const Vec3 from = points.colwise().mean().transpose(), to = surface.vertices.colwise().mean().transpose();
    std::vector<Mat3> turns = spread_turns(even_turns);
    const Mat3 axes = axes_of(points), wanted = axes_of(surface.vertices);
    for (const Mat3& turn : turns_of_a_cube()) turns.push_back(wanted * turn * axes.transpose());
    std::vector<Pose> poses{{RigidMotion{}, 0}};
    for (const Mat3& R : turns) poses.push_back({{R, to - R * from, 1}, 0});
    for (Pose& pose : poses) {
        pose.motion = fit.approached(points, pose.motion, search_steps);
        pose.rms = fit.rms(points, pose.motion);
    }
    std::ranges::sort(poses, {}, &Pose::rms);
    poses.resize(std::min<std::size_t>(poses.size(), kept_poses));
    for (Pose& pose : poses) {
        pose.motion = fit.approached(points, pose.motion, last_steps);
        pose.rms = fit.rms(points, pose.motion);
    }
    std::ranges::sort(poses, {}, &Pose::rms);
    return poses;
}

Points some_of(const Points& points) {
    if (points.rows() <= most_points) return points;
    const std::vector<int> kept = mesh::farthest_points(points, most_points);
    return points(kept, Eigen::all);
}

/// Uncertainty, and what the surface leaves open.
void judge(const SurfaceFit& fit, const Points& points, Registration& result) {
    const SurfaceFit::System system = fit.linearised(result.motion(points));
    const auto n = points.rows();
    result.points = static_cast<int>(n);
    result.rms = fit.rms(points, result.motion);
    result.largest = system.distances.cwiseAbs().maxCoeff();
    const double variance =
        result.rms * result.rms * static_cast<double>(n) / std::max(1.0, static_cast<double>(n) - 6.0);
    const Eigen::SelfAdjointEigenSolver<Matrix6> modes(system.H);
    Matrix6 covariance = Matrix6::Zero();
    for (int i = 0; i < 6; ++i) {
        const Vector6 mode = modes.eigenvectors().col(i);
        if (modes.eigenvalues()[i] > undetermined * modes.eigenvalues()[5]) {
            covariance += variance / modes.eigenvalues()[i] * mode * mode.transpose();
            continue;
        }
        const bool is_turn = mode.head<3>().norm() > mode.tail<3>().norm();
        const Vec3 along = (is_turn ? mode.head<3>() : mode.tail<3>()).normalized();
        result.notes.push_back(
            fmt::format("The surface does not determine the {} [{:.2f}]: it moves into itself that way. "
                        "Name a point there (fiducials).",
                        is_turn ? "turn about" : "shift along", fmt::join(along, ", ")));
    }
    const auto largest_sd = [](const Mat3& C) {
        return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Mat3>(C).eigenvalues()[2]));
    };
    result.rotation_sd = largest_sd(covariance.topLeftCorner<3, 3>()) / fit.size();
    result.translation_sd = largest_sd(covariance.bottomRightCorner<3, 3>());
}

/// Another pose that fits as well.
std::optional<Pose> rival_of(const std::vector<Pose>& poses, const SurfaceFit& fit, const Points& points) {
    constexpr double elsewhere = 0.1;        // of the size: points that far apart are another pose
    const double noise = 1e-4 * fit.size();  // exact data: all poses within are as good
    for (const Pose& pose : poses) {
        const Points apart = pose.motion(points) - poses.front().motion(points);
        if (apart.rowwise().norm().maxCoeff() < elsewhere * fit.size()) continue;
        if (pose.rms < as_good * poses.front().rms + noise) return pose;
    }
    return std::nullopt;
}

}  // namespace

Registration fit_surface(const Points& recorded, const mesh::Surface& surface, const SurfaceFitOptions& options) {
    if (recorded.rows() < 6)
        throw InvalidInput(
            fmt::format("{} points without names cannot be registered to a surface, which takes six at "
                        "least. Name three of them (fiducials).",
                        recorded.rows()));
    const SurfaceFit fit(surface, options.stand_off);
    const Points some = some_of(recorded);
    Registration result;
    if (options.near_only) {
        result.motion = fit.approached(some, {}, last_steps);
    } else {
        const std::vector<Pose> poses = searched(fit, some, surface);
        result.motion = poses.front().motion;
        if (const auto rival = rival_of(poses, fit, some)) {
            const Eigen::AngleAxisd turn(rival->motion.R * result.motion.R.transpose());
            result.notes.push_back(fmt::format(
                "Another pose fits as well ({:.3g} mm rms against {:.3g} mm), turned by {:.0f} degrees about [{:.2f}]: "
                "the "
                "body is symmetric to what was seen of it. Name a point that tells them apart (fiducials).",
                rival->rms, poses.front().rms, turn.angle() * 180 / std::numbers::pi, fmt::join(turn.axis(), ", ")));
        }
        Points reflected = some;
        reflected.col(0) *= -1;
        const double other = searched(fit, reflected, surface).front().rms;
        if (other < mirrored * poses.front().rms)
            result.notes.push_back(
                fmt::format("The mirrored points fit, with {:.3g} mm rms against {:.3g} mm: the frame of "
                            "the recording is left-handed, or the mesh is mirrored. Turn one axis round.",
                            other, poses.front().rms));
    }
    result.motion = fit.approached(recorded, result.motion, last_steps);
    judge(fit, recorded, result);
    return result;
}

}  // namespace palpate::identify
