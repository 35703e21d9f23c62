#include "pipeline/synthesis/external_solver/write_deck.h"

#include "fem/elements/patch_load.h"
#include "identify/measurements/files/probes_table.h"
#include "identify/models/reference/reference_body.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {

int write_deck(const std::filesystem::path& folder, const Specimen& specimen, const Plan& plan) {
    std::vector<identify::LoadState> states;
    for (const ProbeLoadHistory& history : plan.histories)
        for (std::size_t row = 0; row < history.rows.size(); ++row) states.push_back(history.state(row));

    const fem::Material& material = *specimen.material;
    mesh::SolverSetting setting{
        .held = mesh::contains(specimen.set.supports, specimen.volume.nodes),
        .material = {material.young, material.poisson, material.density},
        .is_neo_hookean = specimen.setting.law == static_cast<int>(fem::MaterialLaw::neo_hookean),
        .large_deformation = !specimen.in_small_strain()};
    const auto& reference = dynamic_cast<const identify::ReferenceBody&>(*specimen.model);
    for (const fem::Material& own : reference.region_materials(specimen.setting))
        setting.regions.push_back({own.young, own.poisson, own.density});
    setting.region_of_element = reference.region_of_element();
    const double reach = 0.05 * specimen.model->size();
    for (const identify::LoadState& state : states)
        setting.steps.emplace_back(fem::patch_loads(specimen.volume, state.contacts, reach) *
                                   Eigen::VectorXd::Ones(std::ssize(state.contacts)));
    mesh::write_inp(folder / "body.inp", specimen.volume, setting);
    mesh::write_text(folder / "probes.csv",
                     "# made by palpate: the steps of body.inp\n" + identify::probes_table(states));
    return static_cast<int>(states.size());
}

}  // namespace palpate::pipeline
