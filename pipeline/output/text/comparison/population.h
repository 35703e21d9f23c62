#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// "young [MPa]" of an entry of population.json.
std::string title_of_number(const nlohmann::json& number);
/// What specimens come to together in a sentence: "0.31 (0.29 to 0.33), specimens differ by 8 % (5 to 13 %), ...".
std::string population_in_words(const nlohmann::json& number);
/// Is a number of that name of a single link of a skeleton? Of these there are hundreds.
bool is_of_single_link(const std::string& name);
/// How many there are, and where they stand, or why they are not pooled; empty: none.
std::string single_links_in_words(const nlohmann::json& population);
/// population.json as tables, one a number but for single links.
std::string population_tables(const nlohmann::json& population);

}  // namespace palpate::pipeline
