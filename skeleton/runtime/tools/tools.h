#pragma once

#include <memory>
#include <vector>

#include "fem/rig/rigid_shape.h"
#include "skeleton/runtime/tools/stiff_rows.h"
#include "skeleton/runtime/tools/tool_load.h"

namespace palpate::runtime {

/// Rigid tools that press on the skin without friction. A layer of stiffness k [N/mm^3] lies on the skin: a vertex that
/// stands for the area w, d within a tool, is pushed out by k w d along the tool's normal.
///
/// Which vertices come near is looked up once in a while: those that could not have come within since then are passed
/// over. A vertex is taken to lie within twice as far from the sphere that carries most of it as at rest.
class Tools {
public:
    explicit Tools(const skeleton::Model& model) : model_(model) {}

    /// `shape` about the tool's place, within `extent` of it [mm]; the layer's stiffness [N/mm^3]. The tool's number;
    /// it is away until it is placed. @throws InvalidInput when the model has no skin.
    int add(std::shared_ptr<const fem::RigidShape> shape, double extent, double stiffness);
    int count() const { return static_cast<int>(tools_.size()); }
    void place(int tool, const Vec3& at, const Mat3& turn);
    void lift(int tool) { tools_[tool].is_placed = false; }
    /// Is any tool not away?
    bool any() const;

    /// Adds what the tools do to the spheres at a pose (rows).
    void add_forces(const double* pose, double* force);
    ToolLoad load(int tool, const double* pose);

    /// Moves what is shown of the skin (x, y, z of each vertex) out of the tools at a pose.
    void press_out(const double* pose, std::vector<float>& skin);
    /// Adds a row for each vertex that is touched at a pose.
    void add_rows(const double* pose, StiffRows& stiff);

private:
    struct Tool {
        std::shared_ptr<const fem::RigidShape> shape;
        double extent = 0, stiffness = 0;
        bool is_placed = false;
        Vec3 at = Vec3::Zero();
        Mat3 turn = Mat3::Identity();
        // As it was looked up:
        bool is_known = false;
        Vec3 known_at = Vec3::Zero();
        Mat3 known_turn = Mat3::Identity();
        std::vector<int> near;  // vertices

        double margin() const;              // what comes nearer than this is near [mm]
        double moved() const;               // since it was looked up [mm]
        fem::Gap gap(const Vec3& x) const;  // of a point in space
    };
    void take_skin();
    void look_up(Tool& tool, const double* pose);
    /// Looks up what is out of date.
    void keep_known(const double* pose);
    template <typename Visit>
    void for_each_touch(Tool& tool, const double* pose, const Visit& visit);

    const skeleton::Model& model_;
    std::vector<Tool> tools_;
    std::vector<RuntimePoint> skin_;  // taken with the first tool
    std::vector<double> areas_;       // of each vertex [mm^2]
    struct Carried {
        std::vector<int> vertices;  // that hang on a sphere most
        double reach = 0;           // of them at rest [mm]
    };
    std::vector<Carried> carried_;    // of each sphere
    std::vector<double> known_pose_;  // of the spheres when the tools were looked up
};

}  // namespace palpate::runtime
