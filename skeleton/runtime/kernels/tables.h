#pragma once

#include <cstddef>
#include <new>
#include <vector>

// What the kernels of this folder read and write: plain numbers, four links, spheres or points side by side.

namespace palpate::runtime {

/// Doubles that vector units can load: aligned to a cache line.
template <typename Number>
struct Aligned {
    using value_type = Number;
    static constexpr std::align_val_t line{64};

    Aligned() = default;
    template <typename Other>
    explicit Aligned(const Aligned<Other>&) {}
    Number* allocate(std::size_t n) { return static_cast<Number*>(::operator new(n * sizeof(Number), line)); }
    void deallocate(Number* p, std::size_t) { ::operator delete(p, line); }
    bool operator==(const Aligned&) const { return true; }
};
template <typename Number>
using AlignedVector = std::vector<Number, Aligned<Number>>;

/// A row of eight numbers a sphere:
///   pose      x y z 0  qx qy qz qw   centre [mm], rotation from rest as a unit quaternion
///   velocity  v     0  w     0       [mm/s], [1/s]
///   momentum  p     0  L     0       [tonne mm/s], about the centre [tonne mm^2/s]
///   force     f     0  t     0       [N], [N mm]
/// Two rows more stand at the end, for lanes that hold no link: their spheres are apart and at rest.
using SphereRows = AlignedVector<double>;
constexpr int row_length = 8;

/// Four of the paper's links; a lane without one has stiffness 0.
struct alignas(64) PaperLinks {
    int a[4], b[4];
    double length[4];            // at rest [mm]
    double d0[3][4];             // unit direction at rest
    double kE[4], kF[4], kT[4];  // [N/mm], [N mm/rad]
};

/// Four full links. The axes of a link's section stand at rest as the rotation q_section turns the coordinate axes.
struct alignas(64) FullLinks {
    int a[4], b[4];
    double q_section[4][4];
    double arm_a[3][4], arm_b[3][4];  // from the centres to the section's centroid, in its axes [mm]
    double natural[6][4];  // strains where nothing strains it: with the rest length less the spheres' distance
    double half_area[4];   // of the section, where a sphere's volume is kept, else 0 [mm^2]
    double k[6][4];        // as Stiffness orders them
};

/// Of four full links, how a strain depends on those behind it, as Stiffness orders them: (0, 1), (0, 2) ... (4, 5).
struct alignas(64) SectionCouplings {
    double c[15][4];
};

/// Four spheres as bodies that move. The principal axes of inertia stand at rest as q_axes turns the coordinate axes.
struct alignas(64) Masses {
    double q_axes[4][4];
    double inverse_mass[4];        // [1/tonne]; 0: held
    double inverse_inertia[3][4];  // about those axes [1/(tonne mm^2)]; 0: held
};

}  // namespace palpate::runtime
