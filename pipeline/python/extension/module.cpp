#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/border.h"
#include "pipeline/version.h"

PYBIND11_MODULE(_core, module) {
    using namespace palpate;
    using namespace palpate::python;
    module.doc() = "What palpate is made of. Use the package `palpate`.";
    module.attr("version") = pipeline::version;
    translate_exceptions();
    py::class_<Call>(module, "Call")
        .def(py::init([](int threads, const py::object& seed, bool force, py::object progress, py::object message) {
            pipeline::commands::Common common{.json = false, .force = force, .threads = threads, .seed = {}};
            if (!seed.is_none()) common.seed = seed.cast<std::uint64_t>();
            return Call{common, std::move(progress), std::move(message)};
        }));
    bind_meshes(module);
    bind_sets(module);
    bind_models(module);
    bind_posteriors(module);
    bind_commands(module);
    bind_commands_on_objects(module);
    bind_bodies(module);
    bind_effects(module);
}
