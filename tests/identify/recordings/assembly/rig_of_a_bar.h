#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "identify/numerics/random.h"
#include "identify/recordings/assembly/import_set.h"
#include "mesh/formats/surface/read_surface.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {

/// What a rig would write of a bar of 100 x 20 x 20 mm that is held at x = 0 and pressed at its end by 0, 1, 2 and 0 N:
/// points of a tracker in its own frame, a load cell's log on its own clock, and the CAD file.
struct RigOfABar : ::testing::Test {
    static constexpr double noise = 0.05;       // of a point [mm]
    static constexpr double load_noise = 0.01;  // [N]
    static constexpr double lag = 0.7321;       // t_points = lag + t_load

    TemporaryFolder folder;
    Mat3 R = Eigen::AngleAxisd(1.9, Vec3(2, 1, -1).normalized()).toRotationMatrix();
    Vec3 t = Vec3(500, 200, -300);
    std::vector<Vec3> markers{{25, 10, 20}, {50, 5, 20}, {75, 15, 20}, {100, 10, 20}, {60, 0, 10}, {90, 20, 5}};
    std::vector<Vec3> fiducials{{-10, 0, 0}, {-10, 40, 0}, {-10, 0, 50}, {-30, 10, 10}};

    static double force(double time) {
        const auto on = [&](double at) { return 1 / (1 + std::exp(-(time - at) / 0.04)); };
        return on(2) + on(4.5) - 2 * on(7.2);
    }
    /// What both loggers were given: 5 V from 1.5 s to 6.25 s, and from 8 s on.
    static double sync(double time) { return (time > 1.5 && time < 6.25) || time > 8 ? 5 : 0; }
    static Vec3 bent(const Vec3& at, double newton) { return at - newton * 3e-4 * at.x() * at.x() * Vec3::UnitZ(); }

    RigOfABar() {
        mesh::write_surface(folder / "bar.stl", mesh::make_box({0, 0, 0}, {100, 20, 20}, {20, 4, 4}));
        write_points("points.csv", true);
        write_load("load.csv");
        folder.write("map.yaml", map());
    }

    void write_points(const std::string& name, bool has_fiducials) const {
        std::string text = "time";
        std::vector<Vec3> places = markers;
        if (has_fiducials) places.insert(places.end(), fiducials.begin(), fiducials.end());
        for (std::size_t p = 0; p < places.size(); ++p)
            for (const char* axis : {"x", "y", "z"}) text += "," + point_name(p) + "_" + axis;
        text += ",sync,count\n";
        RandomStream random(1, 1, 1);
        for (int f = 0; f < 900; ++f) {
            const double time = f / 100.0;
            text += std::to_string(time);
            for (std::size_t p = 0; p < places.size(); ++p) {
                const Vec3 at = p < markers.size() ? bent(places[p], force(time)) : places[p];
                const Vec3 seen = R.transpose() * (at - t);
                for (int axis = 0; axis < 3; ++axis) text += "," + std::to_string(seen[axis] + noise * random.normal());
            }
            text += "," + std::to_string(sync(time)) + "," + std::to_string(f) + "\n";
        }
        folder.write(name, text);
    }
    std::string point_name(std::size_t p) const {
        return p < markers.size() ? "m" + std::to_string(p + 1) : "clamp" + std::to_string(p - markers.size() + 1);
    }

    /// @param drift of the cell over the recording [N]
    void write_load(const std::string& name, double drift = 0) const {
        std::string text = "time [s],load [N],sync [V],count\n";
        RandomStream random(1, 2, 1);
        for (int f = 0; f < 8000; ++f) {
            const double time = f / 1000.0;
            text += std::to_string(time) + "," +
                    std::to_string(force(time + lag) + drift * time / 8 + load_noise * random.normal()) + "," +
                    std::to_string(sync(time + lag)) + "," + std::to_string(100 * (time + lag)) + "\n";
        }
        folder.write(name, text);
    }

    static std::string map() {
        return "name: bar\n"
               "mesh: bar.stl\n"
               "supports:\n"
               "  - box: {min: [-1, -1, -1], max: [1, 21, 21]}\n"
               "files:\n"
               "  - {file: points.csv, time: time, points: [\n"
               "      {name: m1, at: [m1_x, m1_y, m1_z]}, {name: m2, at: [m2_x, m2_y, m2_z]},\n"
               "      {name: m3, at: [m3_x, m3_y, m3_z]}, {name: m4, at: [m4_x, m4_y, m4_z]},\n"
               "      {name: m5, at: [m5_x, m5_y, m5_z]}, {name: m6, at: [m6_x, m6_y, m6_z]},\n"
               "      {name: clamp1, at: [clamp1_x, clamp1_y, clamp1_z]}, {name: clamp2, at: [clamp2_x, clamp2_y, "
               "clamp2_z]},\n"
               "      {name: clamp3, at: [clamp3_x, clamp3_y, clamp3_z]}, {name: clamp4, at: [clamp4_x, clamp4_y, "
               "clamp4_z]}]}\n"
               "  - {file: load.csv, time: \"1\", channels: [{column: \"2\", name: load, unit: N}]}\n"
               "fiducials:\n"
               "  - {name: clamp1, at: [-10, 0, 0]}\n"
               "  - {name: clamp2, at: [-10, 40, 0]}\n"
               "  - {name: clamp3, at: [-10, 0, 50]}\n"
               "  - {name: clamp4, at: [-30, 10, 10]}\n"
               "forces:\n"
               "  - {at: [100, 10, 20], radius: 3, along: [0, 0, -1], channel: load}\n"
               "clock: {lag: auto}\n"
               "states: plateaus\n";
    }

    ImportedSet imported() const { return import_set({.map = folder / "map.yaml", .files = {}}); }

    /// What is said when one piece of the map is replaced.
    std::string refusal(const std::string& piece, const std::string& by) const {
        std::string text = map();
        const auto at = text.find(piece);
        EXPECT_NE(at, std::string::npos) << piece;
        folder.write("map.yaml", text.replace(at, piece.size(), by));
        std::string message = message_of<InvalidInput>([&] { imported(); });
        return message.empty() ? "" : message;
    }
    /// Pieces of the map and what stands there instead.
    void change(std::initializer_list<std::pair<std::string, std::string>> pieces) const {
        std::string text = map();
        for (const auto& [piece, by] : pieces) {
            const auto at = text.find(piece);
            ASSERT_NE(at, std::string::npos) << piece;
            text.replace(at, piece.size(), by);
        }
        folder.write("map.yaml", text);
    }
    void change(const std::string& piece, const std::string& by) const { change({{piece, by}}); }
    static std::string all_notes(const ImportedSet& imported) {
        std::string text;
        for (const std::string& note : imported.report.notes) text += note + "\n";
        if (imported.report.registration)
            for (const std::string& note : imported.report.registration->notes) text += note + "\n";
        return text;
    }
};

}  // namespace palpate::identify
