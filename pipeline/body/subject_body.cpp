#include "pipeline/body/subject_body.h"

namespace palpate::pipeline {

MeshedBody make_body(const Subject& subject, const MeshingOptions& options, const Progress& progress) {
    if (!subject.volume) return make_body(subject.surface, options, progress);
    return ready_made_body(*subject.volume, subject.surface, options);
}

}  // namespace palpate::pipeline
