#include <fmt/format.h>

#include <array>
#include <map>
#include <utility>

#include "mesh/errors.h"
#include "mesh/formats/volume/elements.h"
#include "mesh/formats/volume/numbers.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// What Gmsh calls an element type: how many nodes, of which dimension. [Gmsh reference manual, MSH file format]
struct ElementType {
    int nodes, dimension;
    const char* name;
};
const std::map<int, ElementType> element_types{
    {1, {2, 1, "line"}},          {2, {3, 2, "triangle"}},      {3, {4, 2, "quadrangle"}},
    {4, {4, 3, "tetrahedron"}},   {5, {8, 3, "hexahedron"}},    {6, {6, 3, "prism"}},
    {7, {5, 3, "pyramid"}},       {8, {3, 1, "line"}},          {9, {6, 2, "triangle"}},
    {10, {9, 2, "quadrangle"}},   {11, {10, 3, "tetrahedron"}}, {12, {27, 3, "hexahedron"}},
    {13, {18, 3, "prism"}},       {14, {14, 3, "pyramid"}},     {15, {1, 0, "point"}},
    {16, {8, 2, "quadrangle"}},   {17, {20, 3, "hexahedron"}},  {18, {15, 3, "prism"}},
    {19, {13, 3, "pyramid"}},     {20, {9, 2, "triangle"}},     {21, {10, 2, "triangle"}},
    {22, {12, 2, "triangle"}},    {23, {15, 2, "triangle"}},    {24, {15, 2, "triangle"}},
    {25, {21, 2, "triangle"}},    {26, {4, 1, "line"}},         {27, {5, 1, "line"}},
    {28, {6, 1, "line"}},         {29, {20, 3, "tetrahedron"}}, {30, {35, 3, "tetrahedron"}},
    {31, {56, 3, "tetrahedron"}}, {36, {16, 2, "quadrangle"}},  {92, {64, 3, "hexahedron"}},
    {93, {125, 3, "hexahedron"}}};

const ElementType& gmsh_type(int type, const Numbers& numbers) {
    const auto found = element_types.find(type);
    if (found == element_types.end())
        throw InvalidInput(fmt::format("{}: element type {} is not known. Save the mesh with tetrahedra alone.",
                                       numbers.where(), type));
    const ElementType& known = found->second;
    if (known.dimension == 3 && known.nodes != 4 && known.nodes != 10)
        throw InvalidInput(
            fmt::format("{}: a {} of {} nodes (element type {}); tetrahedra of 4 or 10 nodes are allowed. Mesh the "
                        "body with them.",
                        numbers.where(), known.name, known.nodes, type));
    if (known.dimension == 3 && std::string_view(known.name) != "tetrahedron")
        throw InvalidInput(
            fmt::format("{}: a {}; tetrahedra of 4 or 10 nodes are allowed.", numbers.where(), known.name));
    return known;
}

/// Gmsh counts the midsides of edges (2,3) and (1,3) the other way round than VTK.
std::vector<std::int64_t> in_order_of_vtk(std::vector<std::int64_t> nodes) {
    if (nodes.size() == 10) std::swap(nodes[8], nodes[9]);
    return nodes;
}

class GmshReader {
public:
    explicit GmshReader(const std::filesystem::path& file)
        : file_(file), content_(read_text(file)), numbers_(content_, file) {}

    Elements read() {
        const std::string_view first = numbers_.next_word();
        if (first == "$NOD") {
            read_version_1();
            return std::move(elements_);
        }
        read_format(first);
        for (std::string_view word = numbers_.next_word(); !word.empty(); word = numbers_.next_word()) {
            if (word.front() != '$')
                throw InvalidInput(fmt::format("{}: {} stands where a section ($Nodes, $Elements, ...) should begin.",
                                               numbers_.where(), cited(word)));
            read_section(std::string(word.substr(1)));
        }
        return std::move(elements_);
    }

private:
    void read_format(std::string_view first) {
        if (first != "$MeshFormat")
            throw InvalidInput(fmt::format(
                "{}: begins neither with $MeshFormat nor with $NOD (format 1). Save it from Gmsh as MSH 4.1 "
                "or 2.2.",
                file_.string()));
        const std::string version(numbers_.next_word());
        if (version != "2.2" && version != "4.1" && version != "2" && version != "2.1")
            throw InvalidInput(
                fmt::format("{}: is of format {}; 4.1 and 2.2 are allowed. Save it again: gmsh -3 -format "
                            "msh41.",
                            file_.string(), cited(version)));
        is_version_4_ = version == "4.1";
        is_binary_ = numbers_.next_int("1 for binary, 0 for text") == 1;
        numbers_.next_int("the size of a number");
        if (is_binary_) {
            begin_binary();
            if (numbers_.next_int("the number one") != 1)
                throw InvalidInput(fmt::format("{}: was written big-endian. Save it as text.", file_.string()));
            numbers_.set_binary(false);
        }
        end_section("MeshFormat");
    }

    void read_section(const std::string& name) {
        if (name == "Nodes") {
            is_version_4_ ? read_nodes_4() : read_nodes_2();
        } else if (name == "Elements") {
            is_version_4_ ? read_elements_4() : read_elements_2();
        } else if (name == "Entities") {
            read_entities();
        }
        end_section(name);
    }

    void begin_binary() {
        numbers_.skip_line();
        numbers_.set_binary(is_binary_);
    }
    void end_section(const std::string& name) {
        numbers_.set_binary(false);
        if (!numbers_.skip_behind("$End" + name))
            throw InvalidInput(
                fmt::format("{}: ends within ${}. It is cut off: save or copy it again.", file_.string(), name));
    }

    void add_node(std::int64_t number) {
        elements_.node_numbers.push_back(number);
        read_position();
    }
    void read_position() {
        Vec3& at = elements_.nodes.emplace_back();
        for (double& coordinate : at) coordinate = numbers_.next_double("a coordinate");
    }

    // ---- Version 1 ----------------------------------------------------------------------------------------------

    void read_version_1() {
        read_nodes_2();
        end_section_1("NOD");
        if (const std::string_view word = numbers_.next_word(); word != "$ELM")
            throw InvalidInput(fmt::format("{}: {} stands where $ELM, the elements, should begin. Save the mesh again.",
                                           numbers_.where(), word.empty() ? "nothing" : cited(word)));
        std::int64_t left = numbers_.next_count("the number of elements", 8);
        for (; left > 0; --left) read_element_1();
        end_section_1("ELM");
    }

    /// number, type, physical group, geometry, number of nodes, nodes
    void read_element_1() {
        const std::int64_t number = numbers_.next_int("an element's number");
        const ElementType& type = gmsh_type(numbers_.next_int("an element's type"), numbers_);
        const int group = numbers_.next_int("a physical group"), geometry = numbers_.next_int("a geometry");
        if (const int nodes = numbers_.next_int("a number of nodes"); nodes != type.nodes)
            throw InvalidInput(
                fmt::format("{}: element {} tells {} nodes, a {} of its type has {}. Save the mesh again.",
                            numbers_.where(), number, nodes, type.name, type.nodes));
        add_element(number, type, read_corners(type), group != 0 ? group : geometry);
    }

    void end_section_1(const std::string& name) {
        if (numbers_.next_word() != "$END" + name)
            throw InvalidInput(
                fmt::format("{}: $END{} should stand there. The file is cut off, or a count is wrong: save "
                            "or copy it again.",
                            numbers_.where(), name));
    }

    std::vector<std::int64_t> read_corners(const ElementType& type) {
        std::vector<std::int64_t> nodes(static_cast<std::size_t>(type.nodes));
        for (std::int64_t& node : nodes) node = numbers_.next_int("a node of an element");
        return nodes;
    }

    // ---- Version 2.2 --------------------------------------------------------------------------------------------

    void read_nodes_2() {
        const std::int64_t count = numbers_.next_count("the number of nodes", 8);
        begin_binary();
        for (std::int64_t i = 0; i < count; ++i) add_node(numbers_.next_int("a node's number"));
    }

    void read_elements_2() {
        std::int64_t left = numbers_.next_count("the number of elements", 8);
        begin_binary();
        while (left > 0) {
            // In binary files elements of a type stand together behind one head.
            std::int64_t number = is_binary_ ? 0 : numbers_.next_int("an element's number");
            const ElementType& type = gmsh_type(numbers_.next_int("an element's type"), numbers_);
            const int together = is_binary_ ? numbers_.next_int("a number of elements") : 1;
            const int tags = numbers_.next_int("a number of tags");
            if (together < 1 || tags < 0 || tags > 1000)
                throw InvalidInput(fmt::format("{}: {} elements with {} tags are announced. Save the mesh again.",
                                               numbers_.where(), together, tags));
            for (int i = 0; i < together && left > 0; ++i, --left) {
                if (is_binary_) number = numbers_.next_int("an element's number");
                read_element_2(number, type, tags);
            }
        }
    }

    /// The first tag is the physical group, the second the volume of the geometry.
    void read_element_2(std::int64_t number, const ElementType& type, int tags) {
        std::array<int, 2> groups{};
        for (int t = 0; t < tags; ++t) {
            const int tag = numbers_.next_int("a tag");
            if (t < 2) groups[static_cast<std::size_t>(t)] = tag;
        }
        add_element(number, type, read_corners(type), groups[0] != 0 ? groups[0] : groups[1]);
    }

    void add_element(std::int64_t number, const ElementType& type, std::vector<std::int64_t> nodes,
                     std::int64_t material) {
        if (type.dimension < 3) return;
        elements_.add(number, in_order_of_vtk(std::move(nodes)), numbers_.where());
        elements_.materials.push_back(material);
    }

    // ---- Version 4.1 --------------------------------------------------------------------------------------------

    void read_entities() {
        begin_binary();
        std::array<std::int64_t, 4> counts{};
        for (std::int64_t& count : counts) count = numbers_.next_count("a number of entities", 8);
        for (std::size_t dimension = 0; dimension < 4; ++dimension)
            for (std::int64_t i = 0; i < counts[dimension]; ++i) read_entity(dimension);
    }

    void read_entity(std::size_t dimension) {
        const int tag = numbers_.next_int("an entity's number");
        for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) numbers_.next_double("a bound of an entity");
        const std::int64_t groups = numbers_.next_count("a number of physical groups", 1);
        for (std::int64_t g = 0; g < groups; ++g) {
            const int group = numbers_.next_int("a physical group");
            if (dimension == 3 && g == 0) group_of_volume_[tag] = group;
        }
        if (dimension == 0) return;
        const std::int64_t bounds = numbers_.next_count("a number of bounding entities", 1);
        for (std::int64_t b = 0; b < bounds; ++b) numbers_.next_int("a bounding entity");
    }

    void read_nodes_4() {
        begin_binary();
        const std::int64_t blocks = numbers_.next_count("the number of blocks of nodes", 1);
        for (int i = 0; i < 3; ++i) numbers_.next_long("a number of nodes");
        for (std::int64_t b = 0; b < blocks; ++b) {
            const int dimension = numbers_.next_int("an entity's dimension");
            numbers_.next_int("an entity's number");
            const bool is_parametric = numbers_.next_int("1 for parametric nodes, else 0") == 1;
            const std::int64_t count = numbers_.next_count("a number of nodes", 8);
            for (std::int64_t i = 0; i < count; ++i)
                elements_.node_numbers.push_back(numbers_.next_long("a node's number"));
            for (std::int64_t i = 0; i < count; ++i) {
                read_position();
                for (int p = 0; is_parametric && p < dimension; ++p) numbers_.next_double("a parameter of a node");
            }
        }
    }

    void read_elements_4() {
        begin_binary();
        const std::int64_t blocks = numbers_.next_count("the number of blocks of elements", 1);
        for (int i = 0; i < 3; ++i) numbers_.next_long("a number of elements");
        for (std::int64_t b = 0; b < blocks; ++b) {
            numbers_.next_int("an entity's dimension");
            const int entity = numbers_.next_int("an entity's number");
            const ElementType& type = gmsh_type(numbers_.next_int("an element's type"), numbers_);
            const auto group = group_of_volume_.find(entity);
            const std::int64_t material = group != group_of_volume_.end() ? group->second : entity;
            const std::int64_t count = numbers_.next_count("a number of elements", 2);
            for (std::int64_t i = 0; i < count; ++i) {
                const std::int64_t number = numbers_.next_long("an element's number");
                std::vector<std::int64_t> nodes(static_cast<std::size_t>(type.nodes));
                for (std::int64_t& node : nodes) node = numbers_.next_long("a node of an element");
                add_element(number, type, std::move(nodes), material);
            }
        }
    }

    std::filesystem::path file_;
    std::string content_;
    Numbers numbers_;
    bool is_version_4_ = false, is_binary_ = false;
    std::map<int, int> group_of_volume_;
    Elements elements_;
};

}  // namespace

Elements read_gmsh(const std::filesystem::path& file) { return GmshReader(file).read(); }

}  // namespace palpate::mesh
