#pragma once

#include <array>
#include <map>
#include <memory>

#include "skeleton/runtime/forces/fibres.h"
#include "skeleton/runtime/forces/link_tables.h"
#include "skeleton/runtime/forces/point_effects.h"
#include "skeleton/runtime/kernels/link_forces.h"

namespace palpate::runtime {

/// All that acts in a body of itself: its links with the effects that are in them, what keeps its spheres' volumes, and
/// the effects on its points. The energies are those of the model in skeleton/; what it needs to work is made once, so
/// nothing here allocates afterwards.
class ForceField {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    /// @throws InvalidInput when the model has nothing that one of its effects acts on.
    explicit ForceField(const skeleton::Model& model);

    const skeleton::Model& model() const { return model_; }
    /// Does nothing hold a sphere, or do effects in place of a support (flags, N)?
    const std::vector<char>& moves() const { return moves_; }
    /// Acts on all masses beside the effects [mm/s^2].
    void set_gravity(const Vec3& g) { gravity_ = g; }

    /// In the cavities of the skin, beside the effects [MPa]. @throws InvalidInput when it has none.
    void set_pressure(double pressure);
    void set_cavity_pressure(int cavity, double pressure);

    /// Sets the forces on all spheres (rows); returns the potential energy [N mm], without what was dissipated.
    double evaluate(const double* pose, const Rates& rates, double* force);

    /// Spheres a <= b whose second derivative is not zero.
    const std::vector<std::array<int, 2>>& pairs() const { return pairs_; }
    /// d^2 energy / d step^2 of each pair, in exponential coordinates; that of effects on points without the turning of
    /// the points' arms, and of the skin's area and of pressure none.
    const std::vector<Block>& curvature(const double* pose);

    /// Lets a material that remembers have borne how it stands: what flows rests there from then on.
    void settle(const double* pose);
    void forget();
    bool remembers() const { return fibres_ && fibres_->remember(); }

private:
    struct Cell {
        int sphere = 0;
        double stiffness = 0;                               // of the swelling: scale k / V [N/mm^5]
        std::vector<int> links, members, pairs;             // members: the sphere, and the other end of each link
        std::vector<Eigen::Matrix<double, 6, 1>> gradient;  // of the swelling, by each member
    };
    int pair(int a, int b);
    void make_cells();
    double set_cell_pressure(const double* pose, const Rates& rates);
    void add_link_curvature();
    void add_cell_curvature();

    skeleton::Model model_;
    std::vector<char> moves_;
    Vec3 gravity_ = Vec3::Zero();
    std::vector<skeleton::SectionLaw> laws_;  // of each link; empty: none has one
    std::vector<skeleton::Stiffnesses> k_;    // in force, of each link
    PaperTable paper_;
    FullTable full_;
    CouplingTable couplings_;         // empty where no link has a law
    std::unique_ptr<Fibres> fibres_;  // null: no effect is in the links but by their stiffnesses
    std::vector<Cell> cells_;
    std::vector<double> swelling_, pressure_;  // of each sphere [mm^3], [MPa]
    std::unique_ptr<PointEffects> effects_;

    std::map<std::array<int, 2>, int> place_of_pair_;
    std::vector<std::array<int, 2>> pairs_;
    std::vector<int> pair_of_effect_;                              // of each block that the effects visit
    std::vector<std::array<int, 3>> pairs_of_link_;                // (a, a), (a, b), (b, b)
    std::vector<Eigen::Matrix<double, 12, 1>> swelling_gradient_;  // of each link
    std::vector<Block> blocks_;
    Poses poses_;
};

}  // namespace palpate::runtime
