#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/surface/read_surface.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {

/// A closed shell looks into the hollow that it encloses.
inline mesh::Surface with_hollow(mesh::Surface body, const mesh::Surface& hollow) {
    const Eigen::Index vertices = body.vertices.rows(), triangles = body.triangles.rows();
    body.vertices.conservativeResize(vertices + hollow.vertices.rows(), 3);
    body.vertices.bottomRows(hollow.vertices.rows()) = hollow.vertices;
    body.triangles.conservativeResize(triangles + hollow.triangles.rows(), 3);
    for (Eigen::Index t = 0; t < hollow.triangles.rows(); ++t)
        body.triangles.row(triangles + t) = hollow.triangles.row(t).reverse().array() + static_cast<int>(vertices);
    return body;
}

/// A bar of 100 x 20 x 20 with a chamber, held at x = 0: pressed by a ball, pulled and turned by a grip, bent by a
/// tendon and a pressure.
struct RigFiles : ::testing::Test {
    RigFiles() {
        mesh::write_surface(folder / "rest.vtp", with_hollow(bar(), chamber()));
        folder.write("set.yaml", yaml);
        folder.write("motions.csv", motions);
        folder.write("reactions.csv", reactions);
        folder.write("actuations.csv", actuations);
        folder.write("markers.csv", "marker,x,y,z\n7,80,10,20\n3,50,10,0\n");
        folder.write("displacements.csv", displacements);
    }

    static mesh::Surface bar() { return mesh::make_box({0, 0, 0}, {100, 20, 20}, {10, 2, 2}); }
    static mesh::Surface chamber() { return mesh::make_box({20, 6, 3}, {40, 14, 9}, {2, 2, 2}); }

    MeasurementSet read() const { return read_measurement_set(folder.path()); }

    /// What is said when one file holds this instead, which is put back afterwards.
    std::string refusal(const std::string& file, const std::string& text) {
        const std::string before = text_of(file);
        folder.write(file, text);
        std::string message = message_of<InvalidInput>([&] { read(); });
        if (before.empty())
            std::filesystem::remove(folder / file);
        else
            folder.write(file, before);
        return message;
    }
    /// The same with one piece of set.yaml replaced.
    std::string refusal_of_yaml(const std::string& piece, const std::string& by) {
        return refusal("set.yaml", with(piece, by));
    }
    std::string with(const std::string& piece, const std::string& by) const {
        std::string text = yaml;
        text.replace(text.find(piece), piece.size(), by);
        return text;
    }
    std::string text_of(const std::string& file) const {
        std::ifstream stream(folder / file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    const std::string yaml =
        "format: palpate-measurements/2\n"
        "name: rig\n"
        "units: {length: mm, force: N, time: s, angle: deg, pressure: kPa, moment: N*m}\n"
        "rest_surface: rest.vtp\n"
        "supports:\n"
        "  - box: {min: [0, -1, -1], max: [0.1, 21, 21]}\n"
        "tools:\n"
        "  - {name: ball, shape: {sphere: {radius: 5}}, at: [60, 10, 26], contact: frictionless}\n"
        "  - {name: grip, region: {box: {min: [89, -1, -1], max: [101, 21, 21]}}, contact: bonded}\n"
        "actuators:\n"
        "  - {name: chamber, kind: pressure, cavity: {near: [30, 10, 6]}}\n"
        "  - {name: cable, kind: tendon, path: [[0, 10, 15], [50, 10, 15], [80, 10, 12]], by: tension}\n"
        "noise: {position: 0.05, reaction: 0.02, moment: 0.001}\n";
    const std::string motions =
        "probe,time,tool,x,y,z,rx,ry,rz\n"
        "1,0,ball,0,0,-2,0,0,0\n"
        "2,1,grip,1,,0,,0,90\n";
    const std::string reactions =
        "probe,time,tool,fx,fy,fz,mx,my,mz,sigma\n"
        "1,0,ball,,,-0.5,,,,0.1\n"
        "2,1,grip,2,,,,0.25,,\n";
    const std::string actuations =
        "probe,time,actuator,value,sigma\n"
        "2,0,cable,4,0.5\n"
        "3,0,chamber,-5,\n";
    const std::string displacements =
        "probe,time,marker,ux,uy,uz,sigma\n"
        "1,0,7,0.25,,-0.5,0.125\n"
        "3,0,3,0,0,1,\n";
    TemporaryFolder folder;
};

}  // namespace palpate::identify
