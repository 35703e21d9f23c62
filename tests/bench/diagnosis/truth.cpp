#include "diagnosis/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mesh/errors.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> words;
    std::stringstream in(text);
    for (std::string word; std::getline(in, word, at);) words.push_back(word);
    return words;
}

/// Names that other programs give to what the contract calls otherwise.
std::vector<std::string> effects_of(const std::string& name) {
    if (name.starts_with("none")) return {};
    if (name == "nearly-incompressible") return {"volume"};
    return split(name, '+');
}

std::map<std::string, double> numbers_of(const fs::path& file) {
    std::map<std::string, double> numbers;
    std::ifstream in(file);
    if (!in) return numbers;
    const nlohmann::json truth = nlohmann::json::parse(in);
    for (const auto& effect : truth.at("effects")) {
        for (const auto& [name, number] : effect.at("parameters").items()) {
            numbers[effect.at("effect").get<std::string>() + " " + name] = number.at("value").get<double>();
        }
    }
    if (truth.contains("material")) {
        numbers["material young"] = truth["material"].at("young_mpa").get<double>();
        numbers["material poisson"] = truth["material"].at("poisson").get<double>();
    }
    return numbers;
}

}  // namespace

bool Truth::holds(const std::string& effect) const { return std::ranges::find(effects, effect) != effects.end(); }

std::vector<Truth> read_truth(const fs::path& folder) {
    std::ifstream in(folder / "truth.csv");
    if (!in) throw IoError(fmt::format("{} cannot be read", (folder / "truth.csv").string()));
    std::string line;
    std::getline(in, line);
    std::vector<Truth> truths;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = split(line, ',');
        truths.push_back({cells[0], effects_of(cells[1]), std::stod(cells[4]) / std::stod(cells[5]),
                          numbers_of(folder / "truth" / (cells[0] + ".json"))});
    }
    return truths;
}

Outcome judge(const Truth& truth, const identify::Diagnosis& found, const std::vector<std::string>& without) {
    const auto is_true = [&](const std::string& name) { return truth.holds(name); };
    const bool claims = found.verdict == identify::Verdict::missing_effect;
    if (claims && !std::ranges::all_of(found.explanation, is_true)) return Outcome::wrong;
    if (truth.effects.empty()) {
        return found.verdict == identify::Verdict::adequate ? Outcome::right : Outcome::inconclusive;
    }
    if (claims) {
        const bool all = std::ranges::all_of(truth.effects, [&](const std::string& name) {
            return std::ranges::find(found.explanation, name) != found.explanation.end();
        });
        return all ? Outcome::right : Outcome::in_part;
    }
    if (found.verdict == identify::Verdict::ambiguous) {
        const auto end = found.ranking.begin() + std::min<std::ptrdiff_t>(2, std::ssize(found.ranking));
        const bool among =
            std::any_of(found.ranking.begin(), end, [&](const auto& c) { return is_true(c.effect->name()); });
        return among ? Outcome::right : Outcome::wrong;
    }
    const bool left_out = std::ranges::any_of(without, is_true);
    return left_out && found.verdict == identify::Verdict::unexplained ? Outcome::right : Outcome::inconclusive;
}

}  // namespace palpate::bench
