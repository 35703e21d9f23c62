#include "mesh/formats/yaml/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::mesh {

namespace {

/// Builds the tree while the parser reads: what is refused is refused at once, before it can grow.
class TreeBuilder : public YAML::EventHandler {
public:
    explicit TreeBuilder(std::string file) : file_(std::move(file)) {}

    YamlNode take_root() { return std::move(root_); }

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}

    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
        refuse(mark, "aliases (*name) are not read. Write the value out in both places.");
    }
    void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add({.line = mark.line + 1}); }
    void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& value) override {
        add({.kind = YamlNode::Kind::scalar, .line = mark.line + 1, .value = value});
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                         YAML::EmitterStyle::value) override {
        open(mark, YamlNode::Kind::sequence);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
        open(mark, YamlNode::Kind::mapping);
    }
    void OnMapEnd() override { close(); }

private:
    [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& why) const { refuse(mark.line + 1, why); }
    [[noreturn]] void refuse(int line, const std::string& why) const {
        throw InvalidInput(fmt::format("{}, line {}: {}", file_, line, why));
    }

    void open(const YAML::Mark& mark, YamlNode::Kind kind) {
        constexpr std::size_t most_levels = 32;
        if (open_.size() >= most_levels)
            refuse(mark, fmt::format("more than {} levels of lists and mappings inside each other.", most_levels));
        open_.push_back({.kind = kind, .line = mark.line + 1});
        seen_.emplace_back();
    }

    void close() {
        YamlNode node = std::move(open_.back());
        open_.pop_back();
        seen_.pop_back();
        add(std::move(node));
    }

    void add(YamlNode node) {
        if (open_.empty()) {
            root_ = std::move(node);
            return;
        }
        YamlNode& parent = open_.back();
        const bool is_key = parent.kind == YamlNode::Kind::mapping && parent.keys.size() == parent.items.size();
        if (!is_key) {
            // The parser marks nothing at all by what comes next.
            if (node.kind == YamlNode::Kind::empty && !parent.key_lines.empty()) node.line = parent.key_lines.back();
            parent.items.push_back(std::move(node));
            return;
        }
        if (node.kind != YamlNode::Kind::scalar) refuse(node.line, "a field's name must be a word.");
        if (!seen_.back().insert(node.value).second)
            refuse(node.line, fmt::format("the field {} is given twice. Give it once.", cited(node.value)));
        parent.keys.push_back(std::move(node.value));
        parent.key_lines.push_back(node.line);
    }

    std::string file_;
    YamlNode root_;
    std::vector<YamlNode> open_;               // from the root to the innermost
    std::vector<std::set<std::string>> seen_;  // keys of each of them
};

}  // namespace

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& name) {
    const std::string file = name.filename().string();
    require_utf8(text, file);
    std::istringstream stream(text);
    TreeBuilder builder(file);
    try {
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        YamlNode root = builder.take_root();
        if (parser.HandleNextDocument(builder))
            throw InvalidInput(fmt::format("{}: holds several documents (lines of ---). Keep one.", file));
        return root;
    } catch (const YAML::Exception& error) {
        throw InvalidInput(
            fmt::format("{}, line {}: this is no YAML: {}.", file, error.mark.line + 1, cited(error.msg)));
    }
}

}  // namespace palpate::mesh
