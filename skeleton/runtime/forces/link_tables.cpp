#include "skeleton/runtime/forces/link_tables.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "skeleton/links/full_link.h"
#include "skeleton/statics/statics.h"

namespace palpate::runtime {

namespace {

// Sets a lane's ends; lanes beyond the links take the idle rows.
template <typename Batch>
const skeleton::Link* place_lane(const skeleton::Model& model, std::size_t link, Batch& batch, int lane) {
    const bool used = link < model.links.size();
    batch.a[lane] = used ? model.links[link].a : first_idle_row(model);
    batch.b[lane] = used ? model.links[link].b : first_idle_row(model) + 1;
    return used ? &model.links[link] : nullptr;
}

template <int n, typename Vector>
void put(double (&to)[n][4], int lane, const Vector& v) {
    for (int i = 0; i < n; ++i) to[i][lane] = v[i];
}

}  // namespace

PaperTable paper_table(const skeleton::Model& model, const std::vector<skeleton::Stiffnesses>& k) {
    PaperTable table;
    if (model.links.empty() || model.links.front().section) return table;
    table.resize(batches_of(model.links.size()), PaperLinks{});
    for (std::size_t l = 0; l < 4 * table.size(); ++l) {
        PaperLinks& batch = table[l / 4];
        const int lane = static_cast<int>(l % 4);
        const skeleton::Link* link = place_lane(model, l, batch, lane);
        batch.length[lane] = link ? link->length : 1;
        put(batch.d0, lane, link ? skeleton::rest_direction(model, *link) : Vec3(Vec3::UnitX()));
        if (!link) continue;
        batch.kE[lane] = k[l][0];
        batch.kF[lane] = k[l][1];
        batch.kT[lane] = k[l][2];
    }
    return table;
}

FullTable full_table(const skeleton::Model& model, const std::vector<skeleton::Stiffnesses>& k,
                     const std::vector<char>& kept) {
    FullTable table;
    if (model.links.empty() || !model.links.front().section) return table;
    table.resize(batches_of(model.links.size()), FullLinks{});
    for (std::size_t l = 0; l < 4 * table.size(); ++l) {
        FullLinks& batch = table[l / 4];
        const int lane = static_cast<int>(l % 4);
        const skeleton::Link* link = place_lane(model, l, batch, lane);
        batch.q_section[3][lane] = 1;
        if (!link) continue;
        const skeleton::LinkSection& section = *link->section;
        const Vec3 &X_a = model.spheres[link->a].center, &X_b = model.spheres[link->b].center;
        put(batch.q_section, lane, Eigen::Quaterniond(Mat3(section.axes.transpose())).coeffs());
        put(batch.arm_a, lane, Vec3(section.axes * (section.at - X_a)));
        put(batch.arm_b, lane, Vec3(section.axes * (section.at - X_b)));
        skeleton::FullLink::Strains natural = section.natural;
        natural[0] += link->length - (X_b - X_a).norm();
        put(batch.natural, lane, natural);
        batch.half_area[lane] = kept[link->a] || kept[link->b] ? 0.5 * section.area : 0;
        put(batch.k, lane, k[l]);
    }
    return table;
}

CouplingTable coupling_table(const std::vector<skeleton::SectionLaw>& laws) {
    CouplingTable table(batches_of(laws.size()), SectionCouplings{});
    for (std::size_t l = 0; l < laws.size(); ++l) {
        int place = 0;
        for (int j = 0; j < 6; ++j) {
            for (int i = j + 1; i < 6; ++i) table[l / 4].c[place++][l % 4] = laws[l].coupling(j, i);
        }
    }
    return table;
}

MassTable mass_table(const skeleton::Model& model, const std::vector<char>& moves) {
    MassTable table(batches_of(model.spheres.size()), Masses{});
    for (Masses& batch : table) std::fill(std::begin(batch.q_axes[3]), std::end(batch.q_axes[3]), 1);
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        const skeleton::Sphere& sphere = model.spheres[i];
        if (!moves[i] || !(sphere.mass > 0)) continue;
        Masses& batch = table[i / 4];
        const int lane = static_cast<int>(i % 4);
        const Eigen::SelfAdjointEigenSolver<Mat3> principal(sphere.inertia);
        Mat3 axes = principal.eigenvectors();
        if (axes.determinant() < 0) axes.col(2) *= -1;
        put(batch.q_axes, lane, Eigen::Quaterniond(axes).coeffs());
        batch.inverse_mass[lane] = 1 / sphere.mass;
        put(batch.inverse_inertia, lane, Vec3(principal.eigenvalues().cwiseInverse()));
    }
    return table;
}

SphereRows rest_rows(const skeleton::Model& model) {
    SphereRows rows(static_cast<std::size_t>(row_length) * row_count(model), 0.0);
    for (std::size_t i = 0; i < rows.size(); i += row_length) rows[i + 7] = 1;
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        for (int c = 0; c < 3; ++c) rows[row_length * i + c] = model.spheres[i].center[c];
    }
    rows[static_cast<std::size_t>(row_length) * (first_idle_row(model) + 1)] = 1;  // apart by 1 mm
    return rows;
}

}  // namespace palpate::runtime
