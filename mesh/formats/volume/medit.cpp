#include <fmt/format.h>

#include <cctype>

#include "mesh/errors.h"
#include "mesh/formats/volume/elements.h"
#include "mesh/formats/volume/numbers.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

bool is_keyword(std::string_view word) { return !word.empty() && std::isalpha(static_cast<unsigned char>(word[0])); }

void read_vertices(Numbers& numbers, Elements& elements) {
    const std::int64_t count = numbers.next_count("the number of vertices", 8);
    for (std::int64_t v = 1; v <= count; ++v) {
        elements.node_numbers.push_back(v);
        Vec3& at = elements.nodes.emplace_back();
        for (double& coordinate : at) coordinate = numbers.next_double("a coordinate");
        numbers.next_long("a vertex's reference");
    }
}

/// To the next section: over a version, or triangles, edges, corners and the like.
void skip_numbers(Numbers& numbers) {
    while (!numbers.peek_word().empty() && !is_keyword(numbers.peek_word())) numbers.next_word();
}

/// Midsides of quadratic tetrahedra stand in the order of VTK.
void read_tetrahedra(Numbers& numbers, Elements& elements, std::size_t nodes_per_element) {
    const std::int64_t count = numbers.next_count("the number of tetrahedra", 10);
    std::vector<std::int64_t> nodes(nodes_per_element);
    for (std::int64_t e = 1; e <= count; ++e) {
        for (std::int64_t& node : nodes) node = numbers.next_long("a vertex of a tetrahedron");
        elements.add(e, nodes, numbers.where());
        elements.materials.push_back(numbers.next_long("a tetrahedron's reference"));
    }
}

}  // namespace

Elements read_medit(const std::filesystem::path& file) {
    const std::string content = read_text(file);
    Numbers numbers(content, file);
    if (!numbers.next_word().starts_with("MeshVersionFormatted"))
        throw InvalidInput(
            fmt::format("{}: does not begin with MeshVersionFormatted. Save it as a text MEDIT mesh.", file.string()));
    skip_numbers(numbers);
    Elements elements;
    for (std::string_view word = numbers.next_word(); !word.empty() && word != "End"; word = numbers.next_word()) {
        const std::string section(word);
        if (section == "Dimension") {
            if (const int dimension = numbers.next_int("the dimension"); dimension != 3)
                throw InvalidInput(fmt::format("{}: the dimension is {}; 3 is allowed.", numbers.where(), dimension));
        } else if (section == "Vertices") {
            read_vertices(numbers, elements);
        } else if (section == "Tetrahedra") {
            read_tetrahedra(numbers, elements, 4);
        } else if (section == "TetrahedraP2") {
            read_tetrahedra(numbers, elements, 10);
        } else if (section == "Hexahedra" || section == "Prisms" || section == "Pyramids" || section == "Wedges") {
            if (const std::int64_t count = numbers.next_long("a number of elements"); count > 0)
                throw InvalidInput(fmt::format("{}: {} {}; tetrahedra of 4 or 10 nodes are allowed.", numbers.where(),
                                               count, section));
        } else if (!is_keyword(section)) {
            throw InvalidInput(fmt::format("{}: {} stands where a section (Vertices, Tetrahedra, ...) should begin.",
                                           numbers.where(), cited(section)));
        } else {
            skip_numbers(numbers);
        }
    }
    return elements;
}

}  // namespace palpate::mesh
