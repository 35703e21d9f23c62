#pragma once

#include <gtest/gtest.h>

#include <string>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {

/// A bar of 100 x 20 x 20 (of any unit), held at x = 0, with one unloaded and one loaded state.
struct MeasurementSetFiles : ::testing::Test {
    MeasurementSetFiles() {
        write_rest("rest.vtp");
        folder.write("set.yaml", yaml);
        folder.write("probes.csv", probes);
        folder.write("markers.csv", markers);
        folder.write("positions.csv", positions);
    }

    void write_rest(const std::string& name) {
        mesh::write_surface(folder / name, mesh::make_box({0, 0, 0}, {100, 20, 20}, {5, 2, 2}));
    }
    void write_field(const std::string& name) {
        mesh::write_vtu(folder / name, mesh::make_bar({0, 0, 0}, {100, 20, 20}, {1, 1, 1}));
    }
    MeasurementSet read() { return read_measurement_set(folder.path()); }

    /// What is said when one file holds this instead.
    std::string refusal(const std::string& file, const std::string& text) {
        folder.write(file, text);
        return message_of<InvalidInput>([&] { read(); });
    }
    /// The same with one piece of set.yaml replaced.
    std::string refusal_of_yaml(const std::string& piece, const std::string& by) {
        std::string text = yaml;
        text.replace(text.find(piece), piece.size(), by);
        return refusal("set.yaml", text);
    }

    const std::string yaml =
        "format: palpate-measurements/1\n"
        "name: bar\n"
        "units: {length: mm, force: N, time: s}\n"
        "rest_surface: rest.vtp\n"
        "supports:\n"
        "  - box: {min: [0, -1, -1], max: [0.1, 21, 21]}\n";
    const std::string probes =
        "probe,time,x,y,z,fx,fy,fz,radius\n"
        "0,0,0,0,0,0,0,0,0\n"
        "1,0.5,100,10,20,0,0,-2,3\n"
        "1,0.5,50,10,20,1,0,0,0\n";
    const std::string markers =
        "marker,x,y,z,ax,ay,az\n"
        "7,100,10,20,,,\n"
        "3,50,10,26,50,10,20\n";
    const std::string positions =
        "probe,time,marker,x,y,z,sigma\n"
        "0,0,7,100,10,20,\n"
        "1,0.5,7,100,10,18,0.25\n"
        "1,0.50,3,,,25,\n"
        "1,0.5,,60,10,19,\n";
    TemporaryFolder folder;
};

}  // namespace palpate::identify
