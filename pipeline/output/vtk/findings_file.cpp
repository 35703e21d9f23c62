#include "pipeline/output/vtk/findings_file.h"

#include <vtkAppendPolyData.h>
#include <vtkArrowSource.h>
#include <vtkDiskSource.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkTriangleFilter.h>
#include <vtkTubeFilter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "mesh/formats/vtk/vtk_files.h"
#include "pipeline/output/findings.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// As findings_json and the report have them.
constexpr std::array kinds{"arrow", "axis", "ball", "plane", "springs", "swapped"};

Vec3 vector_of(const json& numbers) {
    const auto xyz = numbers.get<std::array<double, 3>>();
    return {xyz[0], xyz[1], xyz[2]};
}

/// Triangles of all findings.
class Drawing {
public:
    explicit Drawing(const skeleton::Model& model) : model_(model) {
        Points body = model.surface.vertices;  // a model may do without
        if (body.rows() == 0) {
            body.resize(std::ssize(model.spheres), 3);
            for (Eigen::Index s = 0; s < body.rows(); ++s)
                body.row(s) = model.spheres[static_cast<std::size_t>(s)].center.transpose();
        }
        middle_ = (body.colwise().minCoeff() + body.colwise().maxCoeff()).transpose() / 2;
        size_ = (body.colwise().maxCoeff() - body.colwise().minCoeff()).maxCoeff();
    }

    void draw(const json& finding) {
        const auto kind = finding["kind"].get<std::string>();
        if (kind == "words") return;
        if (kind == "arrow") {
            const Vec3 vector = vector_of(finding["vector"]), down = vector.normalized();
            arrow(middle_ + 0.12 * size_ * down, 0.25 * size_ * down);
            for (const json& open : finding.value("undetermined", json::array()))
                dashes(middle_ + 0.37 * size_ * down, open, 0.25 * size_ / vector.norm());
        } else if (kind == "axis") {
            const Vec3 along = vector_of(finding["vector"]).normalized();
            for (const double sign : {1, -1}) arrow(middle_, sign * 0.3 * size_ * along);
        } else if (kind == "ball") {
            ball(vector_of(finding["center"]), finding["radius"]);
            if (finding.contains("vector"))
                arrow(vector_of(finding["center"]), 0.25 * size_ * vector_of(finding["vector"]).normalized());
        } else if (kind == "plane") {
            wall(vector_of(finding["vector"]).normalized(), finding["offset"]);
        } else if (kind == "springs") {
            springs();
        }
        number(kind, finding.value("ratio", 1.0));
    }

    /// Two markers that look swapped, where they are at rest.
    void draw_swapped(const Vec3& a, const Vec3& b) {
        tube({a, b});
        number(kinds.back());
    }

    mesh::Surface surface() const {
        mesh::Surface result;
        result.vertices = Eigen::Map<const Points>(places_.data()->data(), std::ssize(places_), 3);
        result.triangles = Eigen::Map<const Triangles>(corners_.data()->data(), std::ssize(corners_), 3);
        return result;
    }
    mesh::MeshData data() const {
        const auto as_array = [](const std::vector<int>& numbers) {
            return Eigen::VectorXd(
                Eigen::Map<const Eigen::VectorXi>(numbers.data(), std::ssize(numbers)).cast<double>());
        };
        return {.cells = {{"finding", as_array(finding_)},
                          {"kind", as_array(kind_)},
                          {"ratio", Eigen::Map<const Eigen::VectorXd>(ratio_.data(), std::ssize(ratio_))}}};
    }
    bool is_empty() const { return corners_.empty(); }

private:
    void arrow(const Vec3& from, const Vec3& along) {
        const vtkNew<vtkArrowSource> unit;  // along x
        unit->SetTipResolution(24);
        unit->SetShaftResolution(24);
        const vtkSmartPointer<vtkTransform> place = turned(from, Vec3::UnitX(), along);
        place->Scale(along.norm(), along.norm(), along.norm());
        add(unit.Get(), place);
    }
    void ball(const Vec3& center, double radius) {
        const vtkNew<vtkSphereSource> unit;
        unit->SetRadius(radius);
        unit->SetThetaResolution(32);
        unit->SetPhiResolution(16);
        add(unit.Get(), turned(center, Vec3::UnitX(), Vec3::UnitX()));
    }
    /// A disk below the sphere that comes nearest to the wall.
    void wall(const Vec3& normal, double offset) {
        const auto height = [&](const skeleton::Sphere& sphere) { return normal.dot(sphere.center) - offset; };
        const auto nearest = std::ranges::min_element(
            model_.spheres, {}, [&](const auto& sphere) { return std::abs(height(sphere)) - sphere.radius; });
        const vtkNew<vtkDiskSource> unit;  // across z
        unit->SetInnerRadius(0);
        unit->SetOuterRadius(0.3 * size_);
        unit->SetCircumferentialResolution(48);
        add(unit.Get(), turned(nearest->center - height(*nearest) * normal, Vec3::UnitZ(), normal));
    }
    /// What is not determined of a vector, `scale` times as long: a dashed line through its tip, over its standard
    /// deviation either way. It ends at half the body's size, as a deviation may be as long as it likes.
    void dashes(const Vec3& tip, const json& open, double scale) {
        const Vec3 axis = vector_of(open["axis"]);
        const double value = open["value"], sd = open["sd"], most = 0.5 * size_;
        const double low = std::max(scale * (value - sd), -most), high = std::min(scale * (value + sd), most);
        const int count = std::max(3, static_cast<int>(std::lround((high - low) / (0.035 * size_))));
        const double pitch = (high - low) / (count - 0.4);
        for (int i = 0; i < count; ++i) tube({tip + (low + i * pitch) * axis, tip + (low + (i + 0.6) * pitch) * axis});
    }
    void tube(const std::vector<Vec3>& places) {
        const vtkNew<vtkPoints> points;
        for (const Vec3& place : places) points->InsertNextPoint(place.data());
        const vtkNew<vtkLineSource> line;
        line->SetPoints(points);
        const vtkNew<vtkTubeFilter> round;
        round->SetInputConnection(line->GetOutputPort());
        round->SetRadius(0.004 * size_);
        round->SetNumberOfSides(12);
        round->CappingOn();
        add(round.Get(), turned(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitX()));
    }
    /// Springs out of spheres that are held, from their surface, away from the body.
    void springs() {
        std::vector<skeleton::Sphere> held;
        std::ranges::copy_if(model_.spheres, std::back_inserter(held), &skeleton::Sphere::held);
        constexpr std::size_t about = 6;
        const std::size_t step = std::max<std::size_t>(1, (held.size() + about - 1) / about);
        for (std::size_t i = 0; i < held.size(); i += step) {
            const Vec3 away = (held[i].center - middle_).normalized();
            const Vec3 side = away.unitOrthogonal(), from = held[i].center + held[i].radius * away;
            std::vector<Vec3> turns{from};
            for (int turn = 1; turn <= 7; ++turn) {
                const double out = turn == 7 ? 0 : turn % 2 == 1 ? 0.02 : -0.02;
                turns.push_back(from + size_ * (0.02 * turn * away + out * side));
            }
            tube(turns);
        }
    }

    /// From the origin to a place, with the direction `from` turned to `to`.
    static vtkSmartPointer<vtkTransform> turned(const Vec3& place, const Vec3& from, const Vec3& to) {
        const auto result = vtkSmartPointer<vtkTransform>::New();
        result->Translate(place.data());
        const Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(from, to));
        result->RotateWXYZ(turn.angle() * 180 / std::numbers::pi, turn.axis().data());
        return result;
    }
    void add(vtkPolyDataAlgorithm* unit, vtkTransform* place) {
        const vtkNew<vtkTransformPolyDataFilter> placed;
        placed->SetInputConnection(unit->GetOutputPort());
        placed->SetTransform(place);
        const vtkNew<vtkTriangleFilter> triangles;
        triangles->SetInputConnection(placed->GetOutputPort());
        triangles->Update();
        vtkPolyData* shape = triangles->GetOutput();
        const auto before = static_cast<int>(places_.size());
        for (vtkIdType p = 0; p < shape->GetNumberOfPoints(); ++p) {
            std::array<double, 3>& at = places_.emplace_back();
            shape->GetPoint(p, at.data());
        }
        for (vtkIdType c = 0; c < shape->GetNumberOfCells(); ++c) {
            vtkIdType count = 0;
            const vtkIdType* corners = nullptr;
            shape->GetCellPoints(c, count, corners);
            std::array<int, 3>& triangle = corners_.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) triangle[k] = before + static_cast<int>(corners[k]);
        }
    }
    /// The triangles since the last finding are of this one.
    void number(const std::string& kind, double ratio = 1) {
        finding_.resize(corners_.size(), count_++);
        ratio_.resize(corners_.size(), ratio);
        kind_.resize(corners_.size(), static_cast<int>(std::ranges::find(kinds, kind) - kinds.begin()));
    }

    const skeleton::Model& model_;
    Vec3 middle_;
    double size_;
    int count_ = 0;
    std::vector<std::array<double, 3>> places_;
    std::vector<std::array<int, 3>> corners_;
    std::vector<int> finding_, kind_;  // of each triangle
    std::vector<double> ratio_;        // a part's stiffness over that of the rest; 1 where a finding is none
};

}  // namespace

void write_findings(const std::filesystem::path& file, const skeleton::Model& model,
                    const identify::MeasurementSet& set, const json& diagnosis) {
    Drawing drawing(model);
    for (const json& finding : findings_json(model.effects, diagnosis)) drawing.draw(finding);
    const json swapped = diagnosis.is_object() ? diagnosis.value("exchanged_markers", json::array()) : json::array();
    for (const json& pair : swapped) {
        const auto rest_of = [&](int id) { return std::ranges::find(set.markers, id, &identify::Marker::id)->rest; };
        drawing.draw_swapped(rest_of(pair["markers"][0]), rest_of(pair["markers"][1]));
    }
    if (drawing.is_empty()) {
        std::filesystem::remove(file);
        return;
    }
    mesh::write_vtp(file, drawing.surface(), drawing.data());
}

}  // namespace palpate::pipeline
