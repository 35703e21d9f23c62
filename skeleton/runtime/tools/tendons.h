#pragma once

#include <vector>

#include "skeleton/runtime/tools/stiff_rows.h"

namespace palpate::runtime {

/// Cables through the body: the first point of a path is fixed in space, each other one hangs on the nearest link. One
/// is let go, pulled by a tension, or drawn in by a length, and is slack then or as stiff as fem::TendonTerms has it.
/// No friction.
class Tendons {
public:
    explicit Tendons(const skeleton::Model& model) : model_(model) {}

    /// `path` (p x 3) [mm]; `stiffness` of the cable, where it is drawn in [N/mm]. The tendon's number.
    /// @throws InvalidInput for less than two points, or two next to each other in one place.
    int add(const Points& path, double stiffness);
    int count() const { return static_cast<int>(tendons_.size()); }
    void pull(int tendon, double tension) { set(tendon, Mode::pulled, tension); }
    void draw(int tendon, double length) { set(tendon, Mode::drawn, length); }
    void let_go(int tendon) { set(tendon, Mode::free, 0); }
    bool any() const;

    /// Adds what the tendons do to the spheres at a pose (rows).
    void add_forces(const double* pose, double* force);
    /// Adds rows for each cable that is taut at a pose: one along it where it is drawn in, and two across each segment.
    void add_rows(const double* pose, StiffRows& stiff);
    double tension(int tendon, const double* pose);  // [N]

private:
    enum class Mode { free, pulled, drawn };
    struct Tendon {
        Vec3 anchor = Vec3::Zero();
        std::vector<RuntimePoint> points;
        double rest_length = 0, stiffness = 0;
        Mode mode = Mode::free;
        double value = 0;
        // as it was placed:
        double tension = 0;
        std::vector<Vec3> along;  // unit, of each segment
        std::vector<double> lengths;
    };
    void set(int tendon, Mode mode, double value);
    static void add_turning_rows(const Tendon& tendon, StiffRows& stiff);
    static void place(Tendon& tendon, const double* pose);
    /// d length / d point k, one of those on the body.
    static Vec3 lengthening(const Tendon& tendon, std::size_t k);

    const skeleton::Model& model_;
    std::vector<Tendon> tendons_;
};

}  // namespace palpate::runtime
