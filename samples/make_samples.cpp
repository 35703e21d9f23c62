// Writes the samples' generated files anew:  build/make_samples samples

#include <filesystem>
#include <iostream>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/surface/read_surface.h"
#include "samples/lattice.h"
#include "samples/organ.h"
#include "skeleton/model/io/model_io.h"

int main(int argc, char** argv) {
    using namespace palpate;
    if (argc != 2) {
        std::cerr << "usage: make_samples FOLDER\n";
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    mesh::write_surface(folder / "organ/organ.stl", samples::make_organ());
    for (const samples::Experiment& experiment :
         {samples::make_cube_experiment(), samples::make_sheet_experiment(), samples::make_two_strings()}) {
        skeleton::write_model(folder / experiment.start.name / "start.json", experiment.start);
        identify::write_measurement_set(folder / experiment.start.name / "set", experiment.set);
    }
}
