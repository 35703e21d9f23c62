#include "pipeline/output/vtk/view_script.h"

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/page/page_parts.h"

namespace palpate::pipeline {

void write_view_script(const std::filesystem::path& script) { mesh::write_text(script, std::string(paraview_text)); }

}  // namespace palpate::pipeline
