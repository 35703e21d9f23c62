// Presses on a calibrated model and tells how far its last sphere moves:  consumer model.json

#include <iostream>

#include "identify/loading/loads.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/statics/equilibrium.h"

int main(int, char** arguments) {
    const palpate::skeleton::Model model = palpate::skeleton::read_model(arguments[1]);
    const palpate::Vec3 tip = model.spheres.back().center;  // [mm]
    const palpate::identify::ContactLoads to_load(model);
    const auto load = to_load({{.point = tip, .force = {0, 0, -0.01}, .radius = 0}});  // [N]
    const auto pressed = palpate::skeleton::equilibrium(model, load);
    std::cout << pressed.state.x.bottomRows<1>() - tip.transpose() << " mm\n";
}
