#include "pipeline/verbs/flags.h"
#include "pipeline/verbs/verbs.h"

// Verbs that play a model, or hand it on to other programs.

namespace palpate::pipeline {

void Verbs::add_simulate(CLI::App& app) {
    auto* sub =
        verb(app, "simulate",
             "Plays the model: equilibria under given contacts, with intervals where a posterior is there, or motion.",
             "  palpate simulate model.json --probes set/probes.csv -o played\n"
             "  palpate simulate model.json --probes set/probes.csv --dt 0.002 --duration 0.5 -o moved\n",
             [this] { return commands::simulate(simulate, common); });
    sub->add_option("MODEL", simulate.model, "model.json")->required();
    sub->add_option("--probes", simulate.probes, "probes.csv: probe,time,x,y,z,fx,fy,fz,radius [mm, N]")->required();
    sub->add_option("-o,--output", simulate.output, "Folder for simulation.pvd; simulation by default");
    sub->add_option("--posterior", simulate.posterior,
                    "Folder with particles.csv and identify.json, which tell how far equilibria can be relied on; by\n"
                    "default that of the model, where they are");
    sub->add_option("--draws", simulate.draws, "Draws from the posterior, for intervals; 0: none")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    auto* dt =
        sub->add_option("--dt", simulate.dt,
                        "Motion: a frame every so many seconds. The load of a row acts since the row before it,\n"
                        "that of a probe's last row to the end. A first row of time 0, before others, is what the\n"
                        "body is in equilibrium with when it begins; without one it begins at rest")
            ->check(CLI::PositiveNumber)
            ->group("Motion");
    auto* duration = sub->add_option("--duration", simulate.duration, "How long each probe is played [s]")
                         ->check(CLI::PositiveNumber)
                         ->needs(dt)
                         ->group("Motion");
    dt->needs(duration);
    sub->add_option("--damping", simulate.damping,
                    "Damping ratio of the softest mode; by default damping as it was identified, or 0.1")
        ->check(CLI::NonNegativeNumber)
        ->needs(dt)
        ->group("Motion");
    sub->add_flag("--implicit", simulate.implicit,
                  "One implicit step a frame: stable and fast, and damped the more the longer dt is")
        ->needs(dt)
        ->group("Motion");
}

void Verbs::add_export(CLI::App& app) {
    auto* sub = verb(app, "export", "The calibrated model for other programs.",
                     "  palpate export model.json --to gltf -o liver.glb        # skinned mesh, spheres as joints\n"
                     "  palpate export model.json --to gltf --probes set/probes.csv -o liver.gltf    # and moving\n"
                     "  palpate export model.json --to stl --probes set/probes.csv --state 3 -o pressed.stl\n"
                     "  palpate export model.json --to sofa -o liver.py\n"
                     "  palpate export model.json --to chai3d -o liver.h\n",
                     [this] { return commands::export_model(exports, common); });
    sub->add_option("MODEL", exports.model, "model.json")->required();
    sub->add_option("--to", exports.to,
                    "gltf (2.0; .glb or .gltf), sofa (a scene in Python), chai3d (C++ for its GEL module), stl, vtp")
        ->required()
        ->check(CLI::IsMember({"gltf", "sofa", "chai3d", "stl", "vtp"}));
    sub->add_option("-o,--output", exports.output, "The file")->required();
    auto* probes =
        sub->add_option("--probes", exports.probes,
                        "probes.csv, whose states are played: gltf moves through them, stl and vtp show one");
    sub->add_option("--state", exports.state, "Which of them stl and vtp show, from 0; the last by default")
        ->check(CLI::NonNegativeNumber)
        ->needs(probes);
}

void Verbs::add_play(CLI::App& app) {
    auto* sub =
        verb(app, "play", "Touch the calibrated model in a browser: drag it, feel its stiffness, switch its effects.",
             "  palpate play runs/organ                                 # serves it to this machine alone\n"
             "  palpate play runs/organ -o organ.html                   # one page that needs no network\n"
             "  palpate play model.json --set measurements -o page.html # with the measured markers\n",
             [this] { return commands::play(play, common); });
    sub->add_option("MODEL", play.model, "model.json, a folder of identify or improve, or a run folder")->required();
    auto* page = sub->add_option("-o,--output", play.output, "The page; without it, it is served at 127.0.0.1");
    sub->add_option("--set", play.set,
                    "Measurement set that is drawn and that the error is told of; by default that of the run");
    sub->add_option("--port", play.port, "Where it is served; a free port by default")
        ->check(CLI::Range(1, 65535))
        ->excludes(page);
}

}  // namespace palpate::pipeline
