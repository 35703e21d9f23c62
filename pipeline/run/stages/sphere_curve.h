#pragma once

#include "pipeline/body/body.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/terminal/outcome.h"
#include "pipeline/run/folder/run_folder.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline::commands {

/// The stage of a run that tells what fewer and more spheres would do: skeletons of a quarter, half, as many and twice
/// as many free spheres as `model` (uncalibrated) has, each fitted link by link to the body in finite elements, and
/// judged on probes held out, as `palpate skeleton --quality` does. Only where the case asks for it: it takes several
/// times as long as the run's own fit, and one number a kind of stiffness, which is quick, does not show what more
/// spheres are good for. What keeps it from a result is said aloud, and no reason to end the run; nobody asked: an
/// older curve is taken away.
void measure_sphere_curve(RunFolder& folder, const Subject& subject, const MeshedBody& body,
                          const skeleton::Model& model, const Common& common);

}  // namespace palpate::pipeline::commands
