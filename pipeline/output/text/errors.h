#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::pipeline {

/// The numbers of an error as JSON states it (`rms_mm` and, where forces of tools were read, `reactions_rms_n`) that
/// stand for it where there is room for one kind: those of the positions; of forces where no position was read.
struct ErrorKeys {
    const char *unit, *fitted, *held_out;
};
ErrorKeys keys_of(const nlohmann::json& error);

/// "0.12 mm", "0.12 mm and 0.004 N" where both were read, "0.004 N" of forces alone; `error`: with `rms_mm` as a
/// number.
std::string rms_in_words(const nlohmann::json& error);
/// The same of what was held out; "" where nothing was.
std::string held_out_rms_in_words(const nlohmann::json& error);

}  // namespace palpate::pipeline
