#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

#include "mesh/core/surface.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh::label_images {

inline constexpr double ball_radius = 12;  // [mm]

/// A label image in memory: voxels by their centres, through axes and origin.
struct Labels {
    std::array<int, 3> size{40, 36, 30};
    Mat3 axes = Mat3::Identity();
    Vec3 origin = Vec3::Zero();
    std::string voxels = std::string(static_cast<std::size_t>(40) * 36 * 30, '\0');

    Vec3 center(int x, int y, int z) const { return axes * Vec3(x, y, z) + origin; }
    Vec3 middle() const { return axes * Vec3(size[0] - 1, size[1] - 1, size[2] - 1) / 2 + origin; }

    template <class Is>
    void fill(char label, const Is& is_inside) {
        std::size_t v = 0;
        for (int z = 0; z < size[2]; ++z)
            for (int y = 0; y < size[1]; ++y)
                for (int x = 0; x < size[0]; ++x, ++v)
                    if (is_inside(center(x, y, z))) voxels[v] = label;
    }
    void fill_ball(char label, const Vec3& at, double radius) {
        fill(label, [&](const Vec3& p) { return (p - at).norm() <= radius; });
    }
};

/// Unequal spacing, turned axes, far from the origin.
Labels oblique_ball();
std::string gzipped(const std::string& bytes);

/// A label image as each format holds it.
std::string meta_image(const Labels& labels, const std::string& more = "");
std::string nrrd(const Labels& labels, const std::string& encoding);
/// Version 1; the place as affine rows, or as a quaternion (whose third axis may be turned).
std::string nifti(const Labels& labels, bool as_quaternion, std::uint8_t unit = 2);
/// Version 2, by affine rows. [nifti2.h]
std::string nifti_2(const Labels& labels, bool is_swapped);

/// Label images as files of a folder.
struct ReadLabels : ::testing::Test {
    std::string refusal(const std::string& name, const std::string& text) {
        return message_of<InvalidInput>([&] { read_body(folder.write(name, text)); });
    }
    TemporaryFolder folder;
};

}  // namespace palpate::mesh::label_images
