#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/recordings/files/c3d/c3d_bytes.h"

namespace palpate::identify {

/// A parameter: numbers, or texts that are all equally long in the file.
struct C3dParameter {
    std::vector<double> numbers;
    std::vector<std::string> texts;  // without blanks at their ends
};

/// The parameters of a C3D file, by "GROUP:NAME" in large letters.
class C3dParameters {
public:
    /// @throws InvalidInput where they are broken.
    explicit C3dParameters(const C3dBytes& bytes);

    bool has(const std::string& name) const { return find(name) != nullptr; }
    double number(const std::string& name, double otherwise) const;
    const std::vector<double>& numbers(const std::string& name) const;
    std::string text(const std::string& name) const;  // "": there is none
    /// Those of NAME, NAME2, NAME3 and so on: a parameter holds at most 255.
    std::vector<std::string> texts(const std::string& name) const;
    std::vector<double> all_numbers(const std::string& name) const;

private:
    const C3dParameter* find(const std::string& name) const;
    std::map<std::string, C3dParameter> parameters_;
};

}  // namespace palpate::identify
