#include "fem/large_deformation/elements/boundary_face.h"

#include <algorithm>
#include <map>

namespace palpate::fem {

std::vector<BoundaryFace> boundary_faces_with_elements(const mesh::VolumeMesh& mesh, const std::vector<int>& faces) {
    std::vector<BoundaryFace> result;
    result.reserve(faces.size());
    std::map<std::array<int, 3>, int> face_at;  // by its midsides, which are its own
    for (const int f : faces) {
        BoundaryFace face;
        for (int i = 0; i < 6; ++i) face.node[i] = mesh.faces(f, i);
        std::array<int, 3> key{face.node[3], face.node[4], face.node[5]};
        std::ranges::sort(key);
        face_at[key] = static_cast<int>(result.size());
        result.push_back(face);
    }
    constexpr int midsides[4][3] = {{4, 5, 6}, {4, 7, 8}, {5, 8, 9}, {6, 7, 9}};  // of each side
    for (int e = 0; e < mesh.tetrahedra.rows(); ++e) {
        const auto element = mesh.tetrahedra.row(e);
        for (const auto& side : midsides) {
            std::array<int, 3> key{element(side[0]), element(side[1]), element(side[2])};
            std::ranges::sort(key);
            const auto found = face_at.find(key);
            if (found == face_at.end()) continue;
            BoundaryFace& face = result[found->second];
            face.element = e;
            for (int i = 0; i < 6; ++i) {
                for (int k = 0; k < element.size(); ++k) {
                    if (element(k) == face.node[i]) face.local[i] = k;
                }
            }
        }
    }
    return result;
}

FaceNodes positions(const BoundaryFace& face, const Points& nodes, const Eigen::VectorXd& u) {
    FaceNodes x;
    for (int i = 0; i < 6; ++i) {
        x.col(i) = nodes.row(face.node[i]).transpose() + u.segment<3>(std::int64_t(3) * face.node[i]);
    }
    return x;
}

}  // namespace palpate::fem
