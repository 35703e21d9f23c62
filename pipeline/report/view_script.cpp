#include "pipeline/report/view_script.h"

#include "mesh/io/atomic_file.h"
#include "pipeline/report/page/page_parts.h"

namespace palpate::pipeline {

void write_view_script(const std::filesystem::path& script) { mesh::write_text(script, std::string(paraview_text)); }

}  // namespace palpate::pipeline
