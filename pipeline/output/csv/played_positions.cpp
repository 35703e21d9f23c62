#include "pipeline/output/csv/played_positions.h"

#include <fmt/format.h>

#include "identify/numerics/summaries.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::pipeline {
namespace {

/// A point of the skin, by the corners of its triangle.
struct OnSkin {
    std::string label;
    Vec3 rest;
    Eigen::Array3i corners;
    Eigen::Array3d shares;
};

std::vector<OnSkin> points_of(const mesh::Surface& skin, const std::vector<identify::Marker>& markers) {
    std::vector<OnSkin> points;
    if (markers.empty()) {
        for (int v = 0; v < skin.vertices.rows(); ++v)
            points.push_back({std::to_string(v), skin.vertices.row(v), {v, v, v}, {1, 0, 0}});
        return points;
    }
    const mesh::SurfaceTree tree(skin);
    for (const identify::Marker& marker : markers) {
        const mesh::SurfacePoint near = tree.closest(marker.anchor.value_or(marker.rest));
        const Eigen::Array3i corners = skin.triangles.row(near.triangle).transpose().array();
        points.push_back({label_of(marker), marker.rest, corners, near.barycentric.array()});
    }
    return points;
}

}  // namespace

std::string played_positions_csv(const skeleton::Model& model, const std::vector<identify::LoadState>& states,
                                 const std::vector<Forecast>& forecasts, const std::vector<identify::Marker>& markers) {
    const std::vector<OnSkin> points = points_of(model.surface, markers);
    std::string text =
        "# palpate: positions of markers in the played model [mm]; within_95: half-width of the 95 % interval of a "
        "coordinate\n"
        "probe,time,marker,x,y,z,ux,uy,uz,sd,within_95\n";
    for (std::size_t s = 0; s < states.size(); ++s) {
        for (const OnSkin& point : points) {
            Vec3 u = Vec3::Zero();
            double sd = 0;
            for (int c = 0; c < 3; ++c) {
                u += point.shares[c] * forecasts[s].displacement.row(point.corners[c]).transpose();
                if (forecasts[s].sd.size() > 0) sd += point.shares[c] * forecasts[s].sd[point.corners[c]];
            }
            const Vec3 x = point.rest + u;
            text += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},", states[s].probe, states[s].time,
                                point.label, x.x(), x.y(), x.z(), u.x(), u.y(), u.z());
            text += forecasts[s].sd.size() > 0 ? fmt::format("{:.4g},{:.4g}\n", sd, identify::sds_of_95_percent * sd)
                                               : ",\n";
        }
    }
    return text;
}

}  // namespace palpate::pipeline
