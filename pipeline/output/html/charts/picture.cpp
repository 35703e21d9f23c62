#include "pipeline/output/html/charts/picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "pipeline/output/html/charts/svg.h"

namespace palpate::pipeline {
namespace {

constexpr double widest = 640;  // [px]

/// Five points of the colour map viridis (van der Walt & Smith 2015), distinguishable by colour-blind readers too.
std::string colour(double share) {
    constexpr std::array<std::array<double, 3>, 5> map{
        {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
    const double at = 4 * std::clamp(share, 0.0, 1.0);
    const auto below = std::min<std::size_t>(3, static_cast<std::size_t>(at));
    const double t = at - static_cast<double>(below);
    const auto mix = [&](std::size_t c) { return (1 - t) * map[below][c] + t * map[below + 1][c]; };
    return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(mix(0)), static_cast<int>(mix(1)),
                       static_cast<int>(mix(2)));
}

/// A parallel view in which the body's longest axis runs across and its shortest one points at the reader, a little
/// from above.
class View {
public:
    explicit View(const Points& points) : box_(mesh::bounding_box(points)) {
        std::array<int, 3> axes{0, 1, 2};
        const Vec3 extent = box_.extent();
        std::sort(axes.begin(), axes.end(),
                  [&](int i, int j) { return extent[i] > extent[j] || (extent[i] == extent[j] && i < j); });
        const Vec3 across = Vec3::Unit(axes[0]), up = Vec3::Unit(axes[1]), toward = across.cross(up);
        const double turn = 0.45, tilt = 0.35;  // [rad]
        const Vec3 right = std::cos(turn) * across + std::sin(turn) * toward;
        const Vec3 front = std::cos(turn) * toward - std::sin(turn) * across;
        rows_.row(0) = right;
        rows_.row(1) = std::cos(tilt) * up - std::sin(tilt) * front;
        rows_.row(2) = std::cos(tilt) * front + std::sin(tilt) * up;
        const Points seen = points * rows_.transpose();
        low_ = seen.colwise().minCoeff();
        const Eigen::RowVector3d size = seen.colwise().maxCoeff() - seen.colwise().minCoeff();
        scale_ = (widest - 2 * margin) / std::max(size[0], size[1]);
        top_ = low_[1] + size[1];
        frame_ = {0, 0, 2 * margin + scale_ * size[0], 2 * margin + scale_ * size[1]};
    }
    /// Makes room for a ball besides what the view was made for; nothing moves.
    void hold(const Vec3& center, double radius = 0) {
        const Vec3 c = (*this)(center);
        const double reach = scale_ * radius + margin;
        frame_.left = std::min(frame_.left, c.x() - reach);
        frame_.top = std::min(frame_.top, c.y() - reach);
        frame_.right = std::max(frame_.right, c.x() + reach);
        frame_.bottom = std::max(frame_.bottom, c.y() + reach);
    }
    /// x, y [px], and depth towards the reader [mm].
    Vec3 operator()(const Vec3& p) const {
        const Vec3 seen = rows_ * p;
        return {margin + scale_ * (seen[0] - low_[0]), margin + scale_ * (top_ - seen[1]), seen[2]};
    }
    Vec3 toward() const { return rows_.row(2); }
    double scale() const { return scale_; }
    std::string open(const std::string& title) const {
        constexpr double bar = 34;  // of colours, below [px]
        return fmt::format(R"(<svg viewBox="{:.0f} {:.0f} {:.0f} {:.0f}" role="img" aria-label="{}"><title>{}</title>)",
                           frame_.left, frame_.top, frame_.right - frame_.left, frame_.bottom - frame_.top + bar, title,
                           title);
    }
    double left() const { return frame_.left; }
    double bottom() const { return frame_.bottom; }

private:
    static constexpr double margin = 10;  // [px]
    struct Frame {
        double left, top, right, bottom;  // [px]
    };
    mesh::Box box_;
    Mat3 rows_;
    Eigen::RowVector3d low_;
    double scale_, top_;
    Frame frame_{};
};

/// The faces that look at the reader, furthest first, shaded.
std::string surface_svg(const skeleton::Model& model, const View& view) {
    const Points normals = mesh::area_vectors(model.surface);
    std::vector<int> facing;
    for (int t = 0; t < normals.rows(); ++t) {
        if (normals.row(t).dot(view.toward()) > 0) facing.push_back(t);
    }
    const auto depth = [&](int t) {
        return (model.surface.vertices.row(model.surface.triangles(t, 0)) +
                model.surface.vertices.row(model.surface.triangles(t, 1)) +
                model.surface.vertices.row(model.surface.triangles(t, 2)))
            .dot(view.toward());
    };
    std::sort(facing.begin(), facing.end(), [&](int i, int j) { return depth(i) < depth(j); });
    std::string svg = R"(<g id="body" stroke-width=".4">)";
    for (const int t : facing) {
        const double light = normals.row(t).normalized().dot(view.toward());
        const int grey = static_cast<int>(150 + 95 * light);
        std::string corners;
        for (int c = 0; c < 3; ++c) {
            const Vec3 p = view(model.surface.vertices.row(model.surface.triangles(t, c)).transpose());
            corners += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
        }
        svg += fmt::format(R"svg(<polygon points="{0}" fill="rgb({1},{1},{1})" stroke="rgb({1},{1},{1})"/>)svg",
                           corners, grey);
    }
    return svg + "</g>";
}

std::string colour_bar(const View& view, double low, double high, const std::string& words) {
    std::string svg;
    constexpr int steps = 40;
    const double x = view.left() + 10, y = view.bottom();
    for (int i = 0; i < steps; ++i) {
        svg += fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="5.2" height="8" fill="{}"/>)", x + 5.0 * i, y + 4,
                           colour((i + 0.5) / steps));
    }
    return svg + fmt::format(R"(<text x="{:.1f}" y="{:.1f}" class="small">{}</text>)"
                             R"(<text x="{:.1f}" y="{:.1f}" class="small" text-anchor="end">{}</text>)"
                             R"(<text x="{:.1f}" y="{:.1f}" class="small">{}</text>)",
                             x, y + 26, plain_number(low), x + 200, y + 26, plain_number(high), x + 210, y + 12, words);
}

Points all_points(const skeleton::Model& model) {
    if (model.surface.vertices.rows() > 0) return model.surface.vertices;
    Points centers(static_cast<Eigen::Index>(model.spheres.size()), 3);
    for (std::size_t s = 0; s < model.spheres.size(); ++s)
        centers.row(static_cast<Eigen::Index>(s)) = model.spheres[s].center;
    return centers;
}

/// From which value to which colours go: the outermost fiftieths share the last ones.
class ColourRange {
public:
    ColourRange(const Eigen::VectorXd& values, bool is_logarithmic) : is_logarithmic_(is_logarithmic) {
        std::vector<double> known;
        for (const double value : values)
            if (!std::isnan(value)) known.push_back(on_scale(value));
        std::sort(known.begin(), known.end());
        if (known.empty()) return;
        low_ = known[known.size() / 50];
        high_ = known[known.size() - 1 - known.size() / 50];
    }
    double share(double value) const { return (on_scale(value) - low_) / std::max(high_ - low_, 1e-9); }
    std::string bar(const View& view, const std::string& words) const {
        return colour_bar(view, is_logarithmic_ ? std::pow(10, low_) : low_,
                          is_logarithmic_ ? std::pow(10, high_) : high_, words);
    }

private:
    double on_scale(double value) const { return is_logarithmic_ ? std::log10(value) : value; }

    bool is_logarithmic_;
    double low_ = 0, high_ = 1;
};

std::string links_svg(const skeleton::Model& model, const View& view, const Eigen::VectorXd& values,
                      const ColourRange& range) {
    std::string svg;
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const double value = values[static_cast<Eigen::Index>(l)];
        const bool is_known = !std::isnan(value);
        const Vec3 a = view(model.spheres[model.links[l].a].center), b = view(model.spheres[model.links[l].b].center);
        svg += fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}" stroke-width="{}"/>)",
                           a.x(), a.y(), b.x(), b.y(), is_known ? colour(range.share(value)) : prior_grey,
                           is_known ? 2.2 : 0.6);
    }
    return svg;
}

}  // namespace

std::string link_picture(const skeleton::Model& model, const LinkValues& values, bool is_first) {
    View view(all_points(model));
    for (const auto& sphere : model.spheres) view.hold(sphere.center);
    const ColourRange range(values.values, values.is_logarithmic);
    return view.open(values.words) + R"(<g opacity=".35">)" +
           (is_first ? surface_svg(model, view) : R"(<use href="#body"/>)") + "</g>" +
           links_svg(model, view, values.values, range) + range.bar(view, values.words) + "</svg>";
}

std::string skeleton_picture(const skeleton::Model& model) {
    View view(all_points(model));
    for (const auto& sphere : model.spheres) view.hold(sphere.center, sphere.radius);
    std::string svg = view.open("Spheres and links of the model in its surface") + R"(<g opacity=".35">)" +
                      surface_svg(model, view) + "</g>";
    Eigen::VectorXd stiffness(static_cast<Eigen::Index>(model.links.size()));
    for (std::size_t l = 0; l < model.links.size(); ++l)
        stiffness[static_cast<Eigen::Index>(l)] = std::max(model.links[l].stiffness[0], 1e-30);
    const ColourRange range(stiffness, true);
    svg += links_svg(model, view, stiffness, range);
    for (const auto& sphere : model.spheres) {
        const Vec3 c = view(sphere.center);
        svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" class="{}"/>)", c.x(), c.y(),
                           view.scale() * sphere.radius, sphere.held ? "held" : "sphere");
        svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.4" class="center"/>)", c.x(), c.y());
    }
    return svg + range.bar(view, "elongation stiffness of links [N/mm], logarithmic") + "</svg>";
}

std::string dot_picture(const skeleton::Model& model, const std::vector<Dot>& dots, double highest,
                        const std::string& unit) {
    View view(all_points(model));
    for (const Dot& dot : dots) view.hold(dot.at);
    std::string svg = view.open("Error at each marker") + R"(<g opacity=".9"><use href="#body"/></g>)";
    std::vector<Dot> sorted = dots;
    std::sort(sorted.begin(), sorted.end(),
              [&](const Dot& a, const Dot& b) { return view(a.at).z() < view(b.at).z(); });
    for (const Dot& dot : sorted) {
        const Vec3 c = view(dot.at);
        svg += fmt::format(
            R"(<circle cx="{:.1f}" cy="{:.1f}" r="4.5" fill="{}" stroke="{}" stroke-width="{}"><title>{:.3g} {}</title></circle>)",
            c.x(), c.y(), colour(highest > 0 ? dot.value / highest : 0), dot.strange ? "#c8741a" : "#fff",
            dot.strange ? 2 : 0.8, dot.value, unit);
    }
    return svg + colour_bar(view, 0, highest, "rms error of each marker over all states [" + unit + "]") + "</svg>";
}

}  // namespace palpate::pipeline
