#include "pipeline/analysis/link_uncertainty.h"

#include <string>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

std::vector<mesh::DataArray> link_uncertainty(const std::vector<identify::PosteriorRow>& posterior,
                                              const Eigen::VectorXd& zones) {
    std::vector<mesh::DataArray> arrays;
    const auto array_of = [&](const std::string& kind) -> Eigen::MatrixXd& {
        const std::string name = kind + " sd/mean [-]";
        for (mesh::DataArray& array : arrays) {
            if (array.name == name) return array.values;
        }
        return arrays.emplace_back(mesh::DataArray{name, Eigen::VectorXd::Constant(zones.size(), identify::missing)})
            .values;
    };
    for (const identify::PosteriorRow& row : posterior) {
        const std::size_t colon = row.parameter.find(':');
        const std::string scope = colon == std::string::npos ? "" : row.parameter.substr(colon + 1);
        if (scope.starts_with("sphere") || row.parameter.starts_with("volume")) continue;  // a sphere's, not a link's
        Eigen::MatrixXd& values = array_of(row.parameter.substr(0, colon));
        const double uncertainty = row.sd / row.mean;
        for (Eigen::Index l = 0; l < zones.size(); ++l) {
            const bool stands_for = row.link >= 0               ? row.link == l
                                    : scope.starts_with("zone") ? std::stod(scope.substr(4)) == zones[l]
                                                                : true;
            if (stands_for) values(l, 0) = uncertainty;
        }
    }
    return arrays;
}

}  // namespace palpate::pipeline
