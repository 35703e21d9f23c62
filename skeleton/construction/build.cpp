#include "skeleton/construction/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "mesh/errors.h"
#include "mesh/numbers/median.h"
#include "skeleton/construction/placement/cover.h"
#include "skeleton/construction/placement/place.h"
#include "skeleton/construction/placement/topology_repair.h"
#include "skeleton/construction/properties/masses.h"
#include "skeleton/construction/properties/sections.h"
#include "skeleton/construction/properties/skin.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::skeleton {
namespace {

constexpr int fineness = 60;               // tetrahedra a sphere, at least
constexpr int least_tetrahedra = 6000;     // however few spheres: cells and their sections are made of these
constexpr double medial_spacing = 0.02;    // of samples, over the diagonal: what is smaller gets no ball of its own
constexpr double usual_coverage = 0.05;    // over the longest side
constexpr double topology_detail = 0.005;  // over the longest side: what is smaller is noise of the surface
constexpr double chain_spacing = 0.5;      // over the mean radius: closer together, spheres fill the body in layers
constexpr double least_stiffness = 1e-3;   // of the median link: slivers must not make the model singular
// Of the spacing, from covering spheres to the others: the widest that covers the body.
constexpr std::array gaps{0.5, 0.25, 0.0};

PlacementBody prepare(const mesh::Surface& surface, const mesh::SurfaceTree& tree, const mesh::VolumeMesh& volume,
                      const std::vector<mesh::Region>& supports, int spheres, double delta) {
    PlacementBody body;
    body.graph = make_tet_graph(volume, std::max(least_tetrahedra, fineness * spheres));
    body.interface = find_support_interface(body.graph, supports);
    body.axis =
        medial_axis(surface, tree, std::min(medial_spacing * mesh::bounding_box(surface.vertices).diagonal(), delta));
    if (body.axis.radii.size() == 0)
        throw InvalidInput("no ball fits into the surface: is it closed, and does it look outward?");
    body.core = find_core(body.graph, body.axis);
    hold_faces_of_plates(body.graph, body.core, body.interface);
    body.free_volumes = body.graph.volumes;
    for (int t = 0; t < body.graph.size(); ++t) {
        if (body.interface.held[t]) body.free_volumes(t) = 0;
    }
    body.path_length = path_lengths(body.graph, body.core.at, body.interface.behind);
    return body;
}

// The surface's vertices that no support holds.
Points free_vertices(const mesh::Surface& surface, const std::vector<mesh::Region>& supports) {
    const std::vector<char> held = mesh::contains(supports, surface.vertices);
    Points points(std::count(held.begin(), held.end(), 0), 3);
    Eigen::Index k = 0;
    for (Eigen::Index v = 0; v < surface.vertices.rows(); ++v) {
        if (!held[v]) points.row(k++) = surface.vertices.row(v);
    }
    return points;
}

// The cells. Held sites without a free neighbour would be isolated: their cells are merged into adjacent ones.
std::vector<int> assign_cells(const PlacementBody& body, std::vector<Site>& sites, std::vector<Sphere>& spheres) {
    for (;;) {
        std::vector<int> owner = grow_cells(body.graph, body.core, body.interface.held, sites);
        std::vector<char> useful(sites.size());
        std::transform(sites.begin(), sites.end(), useful.begin(), [](const Site& site) { return !site.held; });
        for (int t = 0; t < body.graph.size(); ++t) {
            for (int c = 0; c < 4; ++c) {
                const int u = body.graph.neighbors(t, c);
                if (u >= 0 && !sites[owner[u]].held) useful[owner[t]] = 1;
            }
        }
        if (std::find(useful.begin(), useful.end(), 0) == useful.end()) return owner;
        for (std::size_t i = sites.size(); i-- > 0;) {
            if (useful[i]) continue;
            sites.erase(sites.begin() + static_cast<std::ptrdiff_t>(i));
            spheres.erase(spheres.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
}

// An extra sphere covers a corner, and the cell that is left to it is a splinter. But it lies in the same section of
// the body as the sphere that it hangs on, and sections keep their shape: their link is as stout as the stoutest there.
void thicken_extras(const std::vector<Site>& sites, std::vector<Section>& sections) {
    std::vector<Section> stoutest(sites.size());
    for (const Section& s : sections) {
        if (sites[s.a].extra || sites[s.b].extra) continue;
        for (const int end : {s.a, s.b}) {
            if (s.area > stoutest[end].area) stoutest[end] = s;
        }
    }
    for (Section& s : sections) {
        for (const auto& [extra, other] : {std::pair(s.a, s.b), std::pair(s.b, s.a)}) {
            if (!sites[extra].extra) continue;
            s.area = std::max(s.area, stoutest[other].area);
            s.moment_1 = std::max(s.moment_1, stoutest[other].moment_1);
            s.moment_2 = std::max(s.moment_2, stoutest[other].moment_2);
        }
    }
}

std::vector<Link> make_links(const std::vector<Section>& sections, const fem::Material& material, LinkKind kind) {
    std::vector<Link> links;
    links.reserve(sections.size());
    for (const Section& s : sections) {
        Link link{s.a, s.b, s.length, start_stiffness(s, material, kind), 0, radius_of_gyration(s), {}};
        if (is_full(kind)) link.section = {s.centroid, s.axes, s.area};
        links.push_back(std::move(link));
    }

    for (int k = 0; k < (is_full(kind) ? 6 : 3); ++k) {
        std::vector<double> values(links.size());
        std::transform(links.begin(), links.end(), values.begin(), [&](const Link& link) { return link.stiffness(k); });
        const double least = values.empty() ? 0 : least_stiffness * mesh::upper_median(std::move(values));
        for (Link& link : links) link.stiffness(k) = std::max(link.stiffness(k), least);
    }
    return links;
}

// Hooke's law has lambda for the volume, where the body is a lump; limbs and plates bulge as they like.
void set_volume_stiffness(const PlacementBody& body, const std::vector<Site>& sites, const fem::Material& material,
                          std::vector<Sphere>& spheres) {
    for (std::size_t i = 0; i < sites.size(); ++i) {
        if (!sites[i].held && body.core.of(sites[i].tet).dimensions == 3)
            spheres[i].volume = std::max(0., material.lame_lambda());
    }
}

// Bands of equally many links, by the way from the support to their middle.
void set_zones(const PlacementBody& body, const std::vector<Site>& sites, int zones, std::vector<Link>& links) {
    std::vector<double> path_length(links.size());
    std::transform(links.begin(), links.end(), path_length.begin(), [&](const Link& link) {
        return body.path_length(sites[link.a].tet) + body.path_length(sites[link.b].tet);
    });
    std::vector<int> order(links.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return path_length[i] < path_length[j]; });
    for (std::size_t i = 0; i < order.size(); ++i) {
        links[order[i]].zone = static_cast<int>(i * static_cast<std::size_t>(zones) / order.size());
    }
}

}  // namespace

Model build_skeleton(const mesh::Surface& surface, const mesh::VolumeMesh& volume, const fem::Material& material,
                     const std::vector<mesh::Region>& supports, const BuildOptions& options, BuildReport* report) {
    options.validate();
    material.validate();
    const mesh::SurfaceTree tree(surface);
    const double delta =
        options.coverage > 0 ? options.coverage : usual_coverage * mesh::bounding_box(surface.vertices).longest_side();
    PlacementBody body = prepare(surface, tree, volume, supports, options.spheres, delta);
    BuildReport result;
    result.medial_centers = body.axis.centers;
    result.medial_radii = body.axis.radii;

    // How many, and how far apart. Many more than a chain can hold fill the body in layers.
    const int count = options.spheres > 0
                          ? options.spheres
                          : default_spheres(body.graph, body.free_volumes, body.core, body.path_length.maxCoeff());
    double spacing = spacing_of_spheres(body.free_volumes, body.core, count);
    if (spacing < chain_spacing * mean_radius(body.free_volumes, body.core)) {
        body.core = fill_core(body.graph, body.core);
        spacing = spacing_of_spheres(body.free_volumes, body.core, count);
    }

    // Where: spread evenly over the core, and where links could not follow the body else.
    const Handles handles = find_handles(body.graph);
    const double tolerance = topology_detail * mesh::bounding_box(surface.vertices).longest_side();
    std::vector<Site> sites =
        place_sites(body, tree, handles, supports, spacing, tolerance, count, options.spheres > 0);

    // What they leave uncovered gets balls of its own, apart from the others if that will do.
    const Points vertices = free_vertices(surface, supports);
    Model model;
    std::vector<int> owner;
    const auto place_spheres = [&] {
        model.spheres = make_spheres(body, tree, supports, sites, spacing);
        owner = assign_cells(body, sites, model.spheres);
        swell(vertices, delta, model.spheres);
        const Eigen::VectorXd distance = outside(model.spheres, vertices);
        result.coverage = std::max(0., vertices.rows() > 0 ? distance.maxCoeff() : 0);
    };
    place_spheres();
    for (const double gap : gaps) {
        if (options.spheres > 0 || result.coverage <= delta) break;
        const std::vector<Site> added =
            covering_sites(body, supports, sites, model.spheres, vertices, delta, gap * spacing);
        sites.insert(sites.end(), added.begin(), added.end());
        repair_topology(body, tree, handles, tolerance, 2 * count + 8, sites);
        place_spheres();
    }
    if (result.coverage > delta) {
        result.notes.push_back(
            fmt::format("{} spheres leave some of the surface {:.3g} mm outside; {:.3g} mm are wanted: more spheres "
                        "cover it better",
                        free_sites(sites), result.coverage, delta));
    }

    // Assignment of cells to spheres: masses, links, skin.
    set_masses(body.graph, owner, material.density, model.spheres);
    std::vector<Section> sections = find_sections(body.graph, body.core, owner, sites);
    const auto redundant = find_topology_repair(body, tree, handles, owner, sites, tolerance).redundant;
    std::erase_if(sections, [&](const Section& s) { return redundant.count({s.a, s.b}) != 0; });
    thicken_extras(sites, sections);
    model.links = make_links(sections, material, options.links);
    if (is_full(options.links)) set_volume_stiffness(body, sites, material, model.spheres);
    set_zones(body, sites, options.zones, model.links);
    model.surface = surface;
    model.supports = supports;
    if (options.condense) {
        model.skin = make_skin(volume, material, body.graph, owner, model);
    } else {
        for (const auto& vertex : surface.vertices.rowwise()) model.skin.push_back(attach_to_links(model, vertex));
    }
    model.provenance["skeleton"] =
        fmt::format("{} free and {} held spheres, {} links, coverage {:.4g} mm", free_sites(sites),
                    std::ssize(sites) - free_sites(sites), model.links.size(), result.coverage);
    if (report != nullptr) *report = std::move(result);
    return model;
}

}  // namespace palpate::skeleton
