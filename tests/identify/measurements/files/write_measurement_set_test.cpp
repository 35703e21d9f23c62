#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <stdexcept>

#include "tests/identify/measurement_set_files.h"
#include "tests/messages.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

TEST_F(MeasurementSetFiles, AreReadBackEqual) {
    folder.write("clamp.csv", "x,y,z\n0,0,0\n0,20,20\n");
    folder.write("set.yaml", yaml +
                                 "  - sphere: {center: [50.1, 0, 0], radius: 0.3}\n"
                                 "  - plane: {point: [100, 0, 0], normal: [2, 0.7, 0], within: 0.5}\n"
                                 "  - points: {file: clamp.csv, within: 3}\n"
                                 "density: 1070\nhistory: continuous\ngravity: [0, 0.1, -9810]\n"
                                 "noise: {position: 0.05, force: 0.01}\nmaterial: {young: 0.264}\n");
    folder.write("states.csv", "probe,time,gx,gy,gz,pressure\n1,0.5,9810,0,0,\n0,0,,,,0.02\n");
    MeasurementSet set = read();
    set.name = "a \"name\": #1\\\n";
    set.rest_surface.vertices *= 1.0 / 3;  // all digits in use
    for (LoadState& state : set.states) {
        for (mesh::Contact& contact : state.contacts) contact.point /= 3;
        state.time /= 3;
    }
    for (Marker& marker : set.markers) {
        marker.rest /= 3;
        if (marker.anchor) *marker.anchor /= 3;
    }
    write_measurement_set(folder / "copy", set);
    const MeasurementSet read_back = read_measurement_set(folder / "copy");

    EXPECT_EQ(read_back.name, set.name);
    EXPECT_EQ(read_back.rest_surface.vertices, set.rest_surface.vertices);
    EXPECT_EQ(read_back.rest_surface.triangles, set.rest_surface.triangles);
    EXPECT_EQ(read_back.density, set.density);
    EXPECT_EQ(read_back.continuous, set.continuous);
    EXPECT_EQ(read_back.gravity, set.gravity);
    EXPECT_EQ(read_back.position_noise, set.position_noise);
    EXPECT_EQ(read_back.force_noise, set.force_noise);
    EXPECT_EQ(read_back.material->young, set.material->young);
    EXPECT_TRUE(std::isnan(read_back.material->poisson));

    ASSERT_EQ(read_back.supports.size(), set.supports.size());
    EXPECT_EQ(std::get<mesh::BoxRegion>(read_back.supports[0]).max, std::get<mesh::BoxRegion>(set.supports[0]).max);
    EXPECT_EQ(std::get<mesh::SphereRegion>(read_back.supports[1]).center,
              std::get<mesh::SphereRegion>(set.supports[1]).center);
    EXPECT_EQ(std::get<mesh::PlaneRegion>(read_back.supports[2]).normal,
              std::get<mesh::PlaneRegion>(set.supports[2]).normal);
    EXPECT_EQ(std::get<mesh::PointsRegion>(read_back.supports[3]).points,
              std::get<mesh::PointsRegion>(set.supports[3]).points);

    ASSERT_EQ(read_back.markers.size(), set.markers.size());
    for (std::size_t m = 0; m < set.markers.size(); ++m) {
        EXPECT_EQ(read_back.markers[m].id, set.markers[m].id);
        EXPECT_EQ(read_back.markers[m].rest, set.markers[m].rest);
        EXPECT_EQ(read_back.markers[m].anchor, set.markers[m].anchor);
    }
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    const auto all_same = [&](const Vec3& a, const Vec3& b) {
        return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]);
    };
    ASSERT_EQ(read_back.states.size(), set.states.size());
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const LoadState& a = read_back.states[s];
        const LoadState& b = set.states[s];
        EXPECT_EQ(a.probe, b.probe);
        EXPECT_EQ(a.time, b.time);
        EXPECT_TRUE(all_same(a.gravity, b.gravity));
        EXPECT_TRUE(same(a.pressure, b.pressure));
        ASSERT_EQ(a.contacts.size(), b.contacts.size());
        for (std::size_t i = 0; i < a.contacts.size(); ++i) {
            EXPECT_EQ(a.contacts[i].point, b.contacts[i].point);
            EXPECT_EQ(a.contacts[i].force, b.contacts[i].force);
            EXPECT_EQ(a.contacts[i].radius, b.contacts[i].radius);
        }
        ASSERT_EQ(a.readings.size(), b.readings.size());
        for (std::size_t i = 0; i < a.readings.size(); ++i) {
            EXPECT_EQ(a.readings[i].marker, b.readings[i].marker);
            EXPECT_TRUE(all_same(a.readings[i].position, b.readings[i].position));
            EXPECT_TRUE(same(a.readings[i].sigma, b.readings[i].sigma));
        }
    }
}

TEST_F(MeasurementSetFiles, AreWrittenWithWhatTheCallerAdds) {
    const MeasurementSet set = read();
    const auto write = [&] {
        write_measurement_set(folder / "copy", set, [&](const fs::path& inside) {
            for (const LoadState& state : set.states)
                mesh::write_vtu(inside / field_file(state), mesh::make_bar({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
        });
    };
    write();
    folder.write("copy/old.txt", "from before");
    write();  // replaces the folder
    EXPECT_FALSE(fs::exists(folder / "copy/old.txt"));
    const MeasurementSet read_back = read_measurement_set(folder / "copy");
    EXPECT_EQ(read_back.states[1].field, folder / "copy/field/1_0.5.vtu");
}

TEST_F(MeasurementSetFiles, AreWrittenWholeOrNotAtAll) {
    const MeasurementSet set = read();
    const auto entries = [&] { return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()); };
    write_measurement_set(folder / "copy", set);
    const auto before = entries();
    const auto fail = [](const fs::path&) { throw std::runtime_error("disk full"); };
    EXPECT_THROW(write_measurement_set(folder / "copy", set, fail), std::runtime_error);
    EXPECT_THROW(write_measurement_set(folder / "other", set, fail), std::runtime_error);
    EXPECT_EQ(entries(), before);
    EXPECT_EQ(read_measurement_set(folder / "copy").states.size(), 2u);
    EXPECT_TRUE(says(message_of<IoError>([&] { write_measurement_set(folder / "set.yaml" / "x", set); }),
                     {"set.yaml", "cannot be written"}));
}

}  // namespace
}  // namespace palpate::identify
