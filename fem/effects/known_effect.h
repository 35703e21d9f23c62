#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fem/effects/effects.h"
#include "mesh/errors.h"

namespace palpate::fem {

/// A number of an effect.
struct EffectParameter {
    std::string name;  // "gx"
    double value = 0;
    std::string unit;  // "mm/s^2"; "1" where there is none, or none is told
};

/// An effect as it is told, by a model file or a user: a name of the registry and its numbers.
struct EffectRecord {
    std::string name;
    std::vector<EffectParameter> parameters;
};

/// Whose an effect is.
enum class EffectKind {
    body,         // the body has it: it goes into the model
    measurement,  // a fault of the measurement: it goes into how the readings are understood, models only record it
};
/// As files and users have it.
inline const char* kind_name(EffectKind kind) { return kind == EffectKind::body ? "body" : "measurement"; }

/// What a parameter may be.
enum class Range { any, positive, not_negative, poisson, above_minus_one, share };

struct KnownParameter {
    std::string name, unit;  // unit "1": none
    Range range = Range::any;
    bool optional = false;
};
inline KnownParameter optional_parameter(std::string name, std::string unit, Range range = Range::any) {
    return {std::move(name), std::move(unit), range, true};
}

/// The numbers of an effect by name; what is not told is missing.
class EffectNumbers {
public:
    explicit EffectNumbers(std::map<std::string, double> values) : values_(std::move(values)) {}
    bool has(const std::string& name) const { return values_.contains(name); }
    /// @pre it is told, or not optional.
    double operator[](const std::string& name) const { return values_.at(name); }
    Vec3 vector(const std::string& x, const std::string& y, const std::string& z) const {
        return {(*this)[x], (*this)[y], (*this)[z]};
    }
    /// Of unit length, along `n`x, `n`y, `n`z. @throws InvalidInput when all of these are 0.
    Vec3 direction(const std::string& n) const {
        const Vec3 v = vector(n + "x", n + "y", n + "z");
        if (v.isZero(0)) throw InvalidInput(n + "x, " + n + "y and " + n + "z are all 0, but must give a direction");
        return v.normalized();
    }

private:
    std::map<std::string, double> values_;
};

/// An effect in one row: what it is told, how its physics is made of these numbers, and what is special about it.
/// `make` gets what is in range and complete but for optional ones; it throws InvalidInput, in words, for what does not
/// go together. A fault of the measurement has none.
struct KnownEffect {
    std::string name;
    std::vector<KnownParameter> parameters;
    std::function<Effects(const EffectNumbers&)> make;
    EffectKind kind = EffectKind::body;
    std::string not_played = {};  // why no skeleton shows it: "acts on solids alone"; empty: it does
};

}  // namespace palpate::fem
