#include "pipeline/output/vtk/missing_series.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <cmath>

#include "mesh/formats/vtk/vtk_files.h"

namespace palpate::pipeline {
namespace {

using identify::SourceForm;
namespace fs = std::filesystem;

double area_of(const mesh::Surface& surface) {
    double area = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        const Vec3 a = surface.vertices.row(surface.triangles(t, 0)), b = surface.vertices.row(surface.triangles(t, 1)),
                   c = surface.vertices.row(surface.triangles(t, 2));
        area += 0.5 * (b - a).cross(c - a).norm();
    }
    return area;
}

/// An array's name, and what densities are relative to.
struct SourceDensity {
    std::string name;
    double per = 1;
};

SourceDensity density_of(const identify::SourceTerm& term, const mesh::Surface& surface) {
    switch (term.form) {
        case SourceForm::force:
            return {"missing force [N/mm^3]", std::abs(mesh::signed_volume(surface))};
        case SourceForm::traction:
            return {"missing force [N/mm^2]", area_of(surface)};
        case SourceForm::normal:
            if (term.law == identify::SourceLaw::spring) return {"missing springs [N/mm^3]", area_of(surface)};
            return {"missing pressure [N/mm^2]", area_of(surface)};
        case SourceForm::growth:
            return {"missing growth of lengths [-]"};
        case SourceForm::softening:
            return {"missing ln stiffness [-]"};
        case SourceForm::fibres:
            return {"missing stiffness along fibres [-]"};
        default:
            return {};
    }
}

/// How far the readings of markers are off by a source that is the sensors'.
Points off_by_sensor(const identify::SourceTerm& term, const Points& rest, std::size_t state) {
    Points off = Points::Zero(rest.rows(), 3);
    if (term.mean.size() == 0) return off;
    const double strength = term.strength[static_cast<Eigen::Index>(state)];
    if (term.form == SourceForm::marker) off.row(term.number) = strength * term.mean.transpose();
    if (term.form != SourceForm::frame) return off;
    for (Eigen::Index m = 0; m < rest.rows(); ++m) {
        const Vec3 arm = rest.row(m).transpose() - term.centre;
        off.row(m) = strength * (term.mean.head<3>() + Vec3(term.mean.tail<3>()).cross(arm)).transpose();
    }
    return off;
}

}  // namespace

std::string write_missing_series(const fs::path& folder, const identify::MeasurementSet& set,
                                 const identify::Diagnosis& diagnosis) {
    // What an earlier diagnosis located there.
    fs::remove_all(folder / "missing");
    fs::remove(folder / "missing.pvd");
    if (!diagnosis.missing) return {};
    const identify::MissingSource& source = *diagnosis.missing;
    const identify::SourceTerm& term = source.likeliest();
    Points rest(std::ssize(set.markers), 3);
    for (std::size_t m = 0; m < set.markers.size(); ++m)
        rest.row(static_cast<Eigen::Index>(m)) = set.markers[m].rest.transpose();
    const SourceDensity density = density_of(term, set.rest_surface);
    const bool is_vector = term.form == SourceForm::force || term.form == SourceForm::traction;
    std::vector<mesh::SeriesStep> steps;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const fs::path file = folder / "missing" / fmt::format("missing_{:03}.vtp", s);
        if (density.name.empty()) {
            mesh::write_vtp_lines(file, rest, {}, {.points = {{"reading error [mm]", off_by_sensor(term, rest, s)}}});
        } else {
            const identify::SourceField field =
                identify::field_of(source, set.rest_surface.vertices, static_cast<int>(s));
            const Eigen::MatrixXd mean = is_vector ? Eigen::MatrixXd(field.mean) : Eigen::MatrixXd(field.mean.col(0));
            mesh::write_vtp(
                file, set.rest_surface,
                {.points = {{density.name, mean / density.per}, {"standard deviation of it", field.sd / density.per}}});
        }
        steps.push_back({static_cast<double>(s), file});
    }
    mesh::write_pvd(folder / "missing.pvd", steps);
    return "missing.pvd";
}

}  // namespace palpate::pipeline
