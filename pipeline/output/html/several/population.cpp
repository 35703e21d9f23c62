#include "pipeline/output/html/several/population.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/charts/picture.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/output/text/comparison/population.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr double plot_width = 640, label_room = 150, right_room = 20, plot_top = 6, row_height = 22;

/// The axis of a forest plot, in the number's own unit.
class Axis {
public:
    explicit Axis(const json& number) : is_logarithmic_(number["scale"] == "logarithmic") {
        const auto include = [&](const json& interval) {
            low_ = std::min(low_, interval["low"].get<double>());
            high_ = std::max(high_, interval["high"].get<double>());
        };
        include(number["next"]);
        for (const json& one : number["specimens"]) include(one["own"]);
    }
    double at(double value) const {
        const double share =
            is_logarithmic_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
        return label_room + std::clamp(share, 0.0, 1.0) * (plot_width - label_room - right_room);
    }
    std::string ticks(double bottom) const {
        std::string svg;
        const auto add = [&](double tick) {
            svg += stroke(at(tick), plot_top, at(tick), bottom, faint_line) +
                   words_at(at(tick), bottom + 14, fmt::format("{:.4g}", tick), "middle");
        };
        constexpr double wide = 4;  // highest over lowest: from there on decades are clearer than even steps
        if (is_logarithmic_ && high_ > wide * low_) {
            for (double decade = std::pow(10, std::floor(std::log10(low_))); decade <= high_; decade *= 10)
                for (const double digit : {1.0, 2.0, 5.0})
                    if (digit * decade >= low_ && digit * decade <= high_) add(digit * decade);
            return svg;
        }
        const double step = nice_step(high_ - low_);
        for (double tick = std::ceil(low_ / step) * step; tick <= high_; tick += step) add(tick);
        return svg;
    }

private:
    bool is_logarithmic_;
    double low_ = INFINITY, high_ = -INFINITY;
};

std::string mark(const Axis& axis, const json& interval, double y, const char* colour, double thickness) {
    const double x = axis.at(interval["value"]);
    return stroke(axis.at(interval["low"]), y, axis.at(interval["high"]), y,
                  fmt::format(R"(stroke="{}" stroke-width="{}")", colour, thickness).c_str()) +
           fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.5" fill="{}"><title>{:.4g}</title></circle>)", x, y,
                       colour, interval["value"].get<double>());
}

/// By itself in grey, among the others in blue; the population last.
std::string forest_plot(const json& number) {
    const json& specimens = number["specimens"];
    const Axis axis(number);
    const double bottom = plot_top + row_height * (static_cast<double>(specimens.size()) + 2.6);
    std::string svg =
        open_svg(plot_width, bottom + 22, title_of_number(number) + " of each specimen") + axis.ticks(bottom);
    double y = plot_top + row_height * 0.6;
    for (const json& one : specimens) {
        const bool is_outlying = one["outlying"];
        svg += words_at(0, y + 4, (is_outlying ? "✱ " : "") + one["run"].get<std::string>());
        svg += mark(axis, one["own"], y - 3, prior_grey, 2) + mark(axis, one["pooled"], y + 4, posterior_blue, 3);
        y += row_height;
    }
    y += row_height * 0.4;
    svg += words_at(0, y + 4, "next specimen") + mark(axis, number["next"], y - 3, prior_grey, 2);
    svg += words_at(0, y + 4 + row_height, "mean") + mark(axis, number["mean"], y + row_height, posterior_blue, 5);
    return svg + "</svg>";
}

/// Mean and spread over the mean body, of the kind of stiffness that is known of most links.
std::string maps_section(const skeleton::Model& mean, const LinkMap& map) {
    const std::string name = escape(printed_stiffness(map.kind));
    const LinkValues means{map.mean, true,
                           fmt::format("mean {} [{}], logarithmic", name, escape(printed_unit(map.unit)))};
    const LinkValues spreads{100 * map.spread, false, fmt::format("spread of {} [%]", name)};
    return fmt::format(
               "<h2>Map</h2><p>Links of the mean body whose {} two specimens or more determine: {} of {}; thin "
               "grey ones are not determined. Other stiffnesses are in mean_skeleton.vtp.</p>",
               name, map.known(), map.mean.size()) +
           "<div class=\"pair\"><figure>" + link_picture(mean, means, true) +
           "<figcaption class=\"soft\">The mean of the population.</figcaption></figure><figure>" +
           link_picture(mean, spreads, false) +
           "<figcaption class=\"soft\">How specimens differ: one standard deviation.</figcaption></figure></div>";
}

}  // namespace

void write_population_page(const std::filesystem::path& page, const json& population, const skeleton::Model* mean,
                           const std::vector<LinkMap>& maps) {
    std::string sections;
    for (const json& number : population["numbers"]) {
        if (is_of_single_link(number["name"])) continue;
        sections += "<h2>" + escape(title_of_number(number)) + "</h2><p>" + escape(population_in_words(number)) +
                    "</p><figure>" + forest_plot(number) +
                    "<figcaption>Medians and 95 % of each specimen by itself (grey) and among the others (blue), by " +
                    escape(number["of"].get<std::string>()) + "; ✱ unlike the others.</figcaption></figure>";
    }
    if (mean && !maps.empty()) sections += maps_section(*mean, maps.front());
    if (const std::string links = single_links_in_words(population); !links.empty())
        sections += "<p>" + escape(links) + "</p>";
    mesh::write_text(page, page_head("Population", page_style) + "<body><main><h1>Population</h1>" + sections +
                               "</main></body></html>\n");
}

}  // namespace palpate::pipeline
