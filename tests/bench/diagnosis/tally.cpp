#include "diagnosis/tally.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace palpate::bench {
namespace {

double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(std::floor(share * static_cast<double>(values.size() - 1)))];
}

/// What a diagnosis says, in a word or several.
std::string said(const identify::Diagnosis& found) {
    if (found.verdict == identify::Verdict::missing_effect) return joined(found.explanation);
    return identify::verdict_names[static_cast<std::size_t>(found.verdict)];
}

/// The vector or tensor that a number is a component of: "g" of "gx", "s" of "sxy"; empty: none.
std::string vector_of(const std::string& name) {
    const auto end = name.find_last_not_of("xyz") + 1;
    return end == name.size() ? "" : name.substr(0, end);
}

/// What errors of an effect's numbers are measured by: the number itself, or the length of the vector that it is a
/// component of. `aligned`: 1, or -1 where the vector is an axis that was found the other way round.
struct Yardstick {
    double length = 0, aligned = 1;
};

Yardstick yardstick(const Truth& truth, const identify::EffectEstimate& estimate, const std::string& name) {
    const std::string effect = estimate.effect.name + " ";
    const std::string vector = vector_of(name);
    if (vector.empty()) return {std::abs(truth.numbers.at(effect + name)), 1};
    double squares = 0, along = 0;
    for (const skeleton::EffectParameter& one : estimate.effect.parameters) {
        if (vector_of(one.name) != vector) continue;
        const auto known = truth.numbers.find(effect + one.name);
        if (known == truth.numbers.end()) continue;
        squares += known->second * known->second;
        along += known->second * one.value;
    }
    const bool is_axis = estimate.effect.name == "anisotropy";
    return {std::sqrt(squares), is_axis && along < 0 ? -1.0 : 1.0};
}

}  // namespace

std::string joined(const std::vector<std::string>& names) {
    std::vector<std::string> sorted = names;
    std::ranges::sort(sorted);
    return sorted.empty() ? "nothing" : fmt::format("{}", fmt::join(sorted, " + "));
}

void Tally::add_material(const Truth& truth, const identify::MaterialEstimate& material) {
    const auto add = [&](const std::string& name, double value, double sd) {
        const auto known = truth.numbers.find(name);
        if (known == truth.numbers.end() || !(sd > 0)) return;
        numbers_[name].push_back({value / known->second - 1, (value - known->second) / sd});
    };
    add("material young", material.young, material.young_sd);
    add("material poisson", material.poisson, material.poisson_sd);
}

void Tally::add(const Truth& truth, const identify::Diagnosis& found, Outcome outcome,
                const identify::MaterialEstimate& material) {
    ++counts_[outcome];
    ++named_[joined(truth.effects)][said(found)];
    if (truth.effects.empty()) {
        ++nulls_;
        blamed_ += found.explanation.empty() ? 0 : 1;
        double most = -INFINITY;
        for (const identify::Candidate& one : found.ranking) most = std::max(most, one.log_bayes_factor);
        null_evidence_.push_back(most);
    }
    if (outcome != Outcome::right) return;
    add_material(truth, material);
    if (truth.effects.empty() || !found.explained) return;
    before_[joined(truth.effects)].push_back(found.baseline.whitened_rms);
    after_[joined(truth.effects)].push_back(found.explained->fit.whitened_rms);
    for (const auto& effect : found.explained->effects) {
        const identify::EffectEstimate estimate = found.explained->estimate(effect->name());
        for (std::size_t p = 0; p < estimate.effect.parameters.size(); ++p) {
            const skeleton::EffectParameter& one = estimate.effect.parameters[p];
            const auto known = truth.numbers.find(effect->name() + " " + one.name);
            if (known == truth.numbers.end() || !(estimate.sd[p] > 0)) continue;
            const Yardstick by = yardstick(truth, estimate, one.name);
            const double off = one.value - by.aligned * known->second;
            numbers_[known->first].push_back({off / by.length, off / estimate.sd[p]});
        }
    }
}

void Tally::add(const Tally& more) {
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const auto& [outcome, count] : more.counts_) counts_[outcome] += count;
    nulls_ += more.nulls_;
    blamed_ += more.blamed_;
    append(null_evidence_, more.null_evidence_);
    append(seconds_, more.seconds_);
    for (const auto& [hidden, row] : more.named_) {
        for (const auto& [name, times] : row) named_[hidden][name] += times;
    }
    for (const auto& [name, list] : more.numbers_) append(numbers_[name], list);
    for (const auto& [hidden, list] : more.before_) append(before_[hidden], list);
    for (const auto& [hidden, list] : more.after_) append(after_[hidden], list);
}

/// False claims by the evidence alone, at the rates that `--false-claims` may state.
void Tally::print_reliability() const {
    fmt::print("\n| stated rate of false claims | least ln BF | null sets above |\n| --- | --- | --- |\n");
    for (const double rate : {0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4}) {
        identify::DiagnoseOptions options;
        options.false_claims = rate;
        const double least = options.least_evidence();
        const auto above = std::ranges::count_if(null_evidence_, [&](double one) { return one >= least; });
        fmt::print("| {:g} | {:.1f} | {} of {} |\n", rate, least, above, null_evidence_.size());
    }
}

void Tally::print() const {
    const auto count = [&](Outcome outcome) { return counts_.contains(outcome) ? counts_.at(outcome) : 0; };
    fmt::print("\n{} right, {} in part, {} wrong, {} inconclusive; {} of {} null sets blamed.\n", count(Outcome::right),
               count(Outcome::in_part), count(Outcome::wrong), count(Outcome::inconclusive), blamed_, nulls_);
    if (!seconds_.empty()) {
        fmt::print("Seconds: median {:.0f}, 90 % {:.0f}, largest {:.0f}.\n", quantile(seconds_, 0.5),
                   quantile(seconds_, 0.9), quantile(seconds_, 1));
    }
    if (!null_evidence_.empty()) {
        fmt::print(
            "Largest ln BF of any effect in a null set: median {:.1f}, 95 % {:.1f}, 99 % {:.1f}, largest {:.1f}.\n",
            quantile(null_evidence_, 0.5), quantile(null_evidence_, 0.95), quantile(null_evidence_, 0.99),
            quantile(null_evidence_, 1));
        print_reliability();
    }
    std::set<std::string> columns;
    for (const auto& [hidden, row] : named_) {
        for (const auto& [name, times] : row) columns.insert(name);
    }
    fmt::print("\n| hidden \\ said | {} |\n| --- |", fmt::join(columns, " | "));
    for (std::size_t i = 0; i < columns.size(); ++i) fmt::print(" --- |");
    for (const auto& [hidden, row] : named_) {
        fmt::print("\n| {} |", hidden);
        for (const std::string& name : columns) {
            fmt::print(" {} |", row.contains(name) ? std::to_string(row.at(name)) : "");
        }
    }
    if (!after_.empty()) {
        fmt::print(
            "\n\n| named | sets | whitened before | after, median | largest |\n| --- | --- | --- | --- | --- |\n");
    }
    for (const auto& [hidden, after] : after_) {
        fmt::print("| {} | {} | {:.2f} | {:.3f} | {:.3f} |\n", hidden, after.size(), quantile(before_.at(hidden), 0.5),
                   quantile(after, 0.5), quantile(after, 1));
    }
    print_numbers();
}

void Tally::print_numbers() const {
    if (numbers_.empty()) return;
    fmt::print(
        "\n| number | of | error, median | largest | within 10 % | within 1 sd | inside its 95 % interval |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n");
    std::vector<Number> all;
    const auto row = [](const std::string& name, const std::vector<Number>& list) {
        std::vector<double> errors;
        for (const Number& number : list) errors.push_back(std::abs(number.error));
        const auto within = [](const std::vector<Number>& of, double Number::*what, double most) {
            return std::ranges::count_if(of, [&](const Number& number) { return std::abs(number.*what) <= most; });
        };
        constexpr double sd_95 = 1.96;
        fmt::print("| {} | {} | {:.1f} % | {:.1f} % | {} | {} | {} |\n", name, list.size(), 100 * quantile(errors, 0.5),
                   100 * quantile(errors, 1), within(list, &Number::error, 0.1), within(list, &Number::z, 1),
                   within(list, &Number::z, sd_95));
    };
    for (const auto& [name, list] : numbers_) {
        row(name, list);
        all.insert(all.end(), list.begin(), list.end());
    }
    row("all", all);
}

}  // namespace palpate::bench
