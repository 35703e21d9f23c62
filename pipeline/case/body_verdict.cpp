#include "pipeline/case/body_verdict.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "mesh/text/words.h"
#include "mesh/topology/shells.h"

namespace palpate::pipeline {
namespace {

/// Parts that belong together, by their boxes.
class Pieces {
public:
    explicit Pieces(const mesh::Surface& surface) : surface_(surface), part_of_(mesh::connected_parts(surface)) {
        const int parts = part_of_.empty() ? 0 : *std::ranges::max_element(part_of_) + 1;
        boxes_.assign(static_cast<std::size_t>(parts), {Vec3::Constant(INFINITY), Vec3::Constant(-INFINITY)});
        for (std::size_t t = 0; t < part_of_.size(); ++t) {
            mesh::Box& box = boxes_[static_cast<std::size_t>(part_of_[t])];
            for (int c = 0; c < 3; ++c) {
                const Vec3 corner = surface.vertices.row(surface.triangles(static_cast<Eigen::Index>(t), c));
                box.min = box.min.cwiseMin(corner);
                box.max = box.max.cwiseMax(corner);
            }
        }
        piece_of_part_.resize(boxes_.size());
        std::iota(piece_of_part_.begin(), piece_of_part_.end(), 0);
        unite();
    }

    /// Its triangles' boxes together, of each piece.
    std::vector<std::pair<int, mesh::Box>> boxes() const {
        std::vector<std::pair<int, mesh::Box>> result;
        for (std::size_t p = 0; p < boxes_.size(); ++p)
            if (piece_of_part_[p] == static_cast<int>(p)) result.emplace_back(static_cast<int>(p), boxes_[p]);
        return result;
    }

    mesh::Surface only(const std::vector<int>& pieces) const {
        mesh::Surface result{surface_.vertices, {}};
        std::vector<Eigen::Index> rows;
        for (std::size_t t = 0; t < part_of_.size(); ++t) {
            const int piece = piece_of_part_[static_cast<std::size_t>(part_of_[t])];
            if (std::ranges::find(pieces, piece) != pieces.end()) rows.push_back(static_cast<Eigen::Index>(t));
        }
        result.triangles = surface_.triangles(rows, Eigen::all);
        // without the vertices that are left over
        std::vector<int> number(static_cast<std::size_t>(result.vertices.rows()), -1);
        std::vector<Eigen::Index> used;
        for (int& v : result.triangles.reshaped()) {
            int& own = number[static_cast<std::size_t>(v)];
            if (own < 0) {
                own = static_cast<int>(used.size());
                used.push_back(v);
            }
            v = own;
        }
        result.vertices = surface_.vertices(used, Eigen::all);
        return result;
    }

private:
    /// Boxes that meet are joined, until all that are left are apart.
    void unite() {
        const double slack = 1e-6 * mesh::bounding_box(surface_.vertices).longest_side();
        for (bool is_changed = true; is_changed;) {
            is_changed = false;
            for (std::size_t a = 0; a < boxes_.size(); ++a) {
                if (piece_of_part_[a] != static_cast<int>(a)) continue;
                for (std::size_t b = a + 1; b < boxes_.size(); ++b) {
                    if (piece_of_part_[b] != static_cast<int>(b) || !meet(boxes_[a], boxes_[b], slack)) continue;
                    boxes_[a].min = boxes_[a].min.cwiseMin(boxes_[b].min);
                    boxes_[a].max = boxes_[a].max.cwiseMax(boxes_[b].max);
                    std::ranges::replace(piece_of_part_, static_cast<int>(b), static_cast<int>(a));
                    is_changed = true;
                }
            }
        }
    }

    static bool meet(const mesh::Box& a, const mesh::Box& b, double slack) {
        return ((a.min - b.max).array() <= slack).all() && ((b.min - a.max).array() <= slack).all();
    }

    const mesh::Surface& surface_;
    std::vector<int> part_of_;        // of each triangle
    std::vector<mesh::Box> boxes_;    // of each part; of a piece's first part the piece's
    std::vector<int> piece_of_part_;  // the first part of its piece
};

std::string size_in_words(const mesh::Box& box) {
    const Vec3 size = box.extent();
    return fmt::format("{:.3g} x {:.3g} x {:.3g} mm at ({:.3g}, {:.3g}, {:.3g})", size.x(), size.y(), size.z(),
                       box.min.x(), box.min.y(), box.min.z());
}

}  // namespace

KeptSurface keep_pieces(const mesh::Surface& surface, KeptPieces kept) {
    const Pieces pieces(surface);
    std::vector<std::pair<int, mesh::Box>> boxes = pieces.boxes();
    if (boxes.size() < 2 || kept == KeptPieces::all) return {surface, {}};
    std::ranges::stable_sort(boxes, std::greater{}, [](const auto& piece) { return piece.second.extent().norm(); });

    constexpr double crumb = 0.1;  // of the largest piece's diagonal: a thousandth of its volume
    const double largest = boxes.front().second.extent().norm();
    std::vector<int> body{boxes.front().first};
    KeptSurface result;
    std::vector<std::string> others;
    for (std::size_t i = 1; i < boxes.size(); ++i) {
        const auto& [piece, box] = boxes[i];
        const bool counts = kept == KeptPieces::automatic && box.extent().norm() > crumb * largest;
        if (counts) {
            body.push_back(piece);
            others.push_back(size_in_words(box));
        } else {
            result.notes.push_back(
                fmt::format("A piece of {} that does not touch the body is left out (--keep all "
                            "keeps it).",
                            size_in_words(box)));
        }
    }
    result.surface = pieces.only(body);
    if (!others.empty()) {
        constexpr std::size_t most = 3;  // that a message has room for
        const std::size_t more = others.size() - std::min(most, others.size());
        others.resize(std::min(most, others.size()));
        result.refusal = fmt::format(
            "the surface is of {} pieces that do not touch, the largest {}, others {}{}: one body is needed. --keep "
            "largest takes the largest, --keep all takes them all, each of which must then be held",
            body.size(), size_in_words(boxes.front().second), fmt::join(others, "; "),
            more > 0 ? fmt::format(" and {} more", more) : "");
    }
    return result;
}

std::string refusal_of_flat(const mesh::Surface& surface) {
    if (surface.vertices.rows() < 3) return {};
    const Points centred = surface.vertices.rowwise() - surface.vertices.colwise().mean();
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(Mat3(centred.transpose() * centred));
    const Points along = centred * axes.eigenvectors();
    const Eigen::RowVector3d extent = along.colwise().maxCoeff() - along.colwise().minCoeff();
    constexpr double least = 1e-4;  // of the longest side: foil of 10 um over 100 mm
    if (extent.minCoeff() > least * extent.maxCoeff()) return {};
    return fmt::format(
        "the surface is flat, {:.3g} mm long and {:.3g} mm thick, and encloses nothing. A body has a thickness: give "
        "the "
        "closed surface of a solid",
        extent.maxCoeff(), extent.minCoeff());
}

}  // namespace palpate::pipeline
