#include "pipeline/case/region_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/material.h"
#include "identify/measurements/files/path_inside.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

constexpr const char* region_form =
    "write NAME:surface=FILE,young=MPA or NAME:label=N,young=MPA, and after that poisson=NU or density=KG_M3 where "
    "they are not the body's, as in bone:surface=bone.stl,young=20";

class RegionSpecReader {
public:
    explicit RegionSpecReader(const std::string& spec) : where_(fmt::format("--region {}", mesh::cited(spec))) {
        const auto colon = spec.find(':');
        if (colon == 0 || colon == std::string::npos) refuse("names no region");
        region_.name = spec.substr(0, colon);
        for (std::size_t from = colon + 1; from <= spec.size();) {
            const std::size_t to = std::min(spec.find(',', from), spec.size());
            take(spec.substr(from, to - from));
            from = to + 1;
        }
    }

    mesh::MaterialRegion execute() {
        if (region_.file.empty() != region_.label.has_value())
            refuse(region_.file.empty() ? "has no surface" : "has two places");
        if (!region_.young) refuse("has no young");
        check_ranges();
        if (!region_.label)
            region_.surface =
                identify::read_closed_surface(region_.file, 1.0, where_, fmt::format("the region '{}'", region_.name));
        return std::move(region_);
    }

private:
    [[noreturn]] void refuse(const std::string& what) const {
        throw InvalidInput(fmt::format("{}: it {}; {}.", where_, what, region_form));
    }

    void take(const std::string& item) {
        const auto equals = item.find('=');
        const std::string key = item.substr(0, equals);
        if (equals == std::string::npos) refuse(fmt::format("says {}, which is not name=value", mesh::cited(item)));
        const std::string value = item.substr(equals + 1);
        if (key == "surface") {
            region_.file = value;
        } else if (key == "label") {
            const double label = number(key, value);
            if (label != std::round(label) || std::abs(label) > std::numeric_limits<int>::max())
                refuse(fmt::format("has label = {}, which is no whole number", mesh::cited(value)));
            region_.label = static_cast<int>(label);
        } else if (key == "young") {
            region_.young = number(key, value);
        } else if (key == "poisson") {
            region_.poisson = number(key, value);
        } else if (key == "density") {
            region_.density = fem::tonne_per_mm3 * number(key, value);
        } else {
            refuse(fmt::format("says {}, which no region has", mesh::cited(key)));
        }
    }

    double number(const std::string& key, const std::string& value) const {
        const auto parsed = mesh::parse_number(value);
        if (!parsed) refuse(fmt::format("has {} = {}, which is no number", key, mesh::cited(value)));
        return *parsed;
    }

    void check_ranges() const {
        fem::Material material{.young = *region_.young};
        if (region_.poisson) material.poisson = *region_.poisson;
        if (region_.density) material.density = *region_.density;
        try {
            material.validate();
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("{}: {}", where_, error.what()));
        }
    }

    std::string where_;
    mesh::MaterialRegion region_{};
};

}  // namespace

mesh::MaterialRegion read_region_spec(const std::string& spec) { return RegionSpecReader(spec).execute(); }

}  // namespace palpate::pipeline
