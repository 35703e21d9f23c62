#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>

#include "mesh/errors.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"
#include "skeleton/effects/effect.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using skeleton::Link, skeleton::Model, skeleton::Sphere;

Eigen::Index kinds_of(const Model& model) { return model.links.empty() ? 3 : model.links.front().stiffness.size(); }

void set_stiffness(Model& model, const py::object& given) {
    const Eigen::MatrixXd k = matrix_of(given, "stiffness", std::ssize(model.links), kinds_of(model));
    for (Eigen::Index link = 0; link < k.rows(); ++link) {
        for (Eigen::Index kind = 0; kind < k.cols(); ++kind) {
            if (k(link, kind) >= 0 && std::isfinite(k(link, kind))) continue;
            throw InvalidInput(fmt::format("stiffness: {} of link {} is {} {}, must be finite and at least 0",
                                           skeleton::stiffness_names[kind], link, k(link, kind),
                                           skeleton::stiffness_units[kind]));
        }
    }
    for (Eigen::Index link = 0; link < k.rows(); ++link)
        model.links[static_cast<std::size_t>(link)].stiffness = k.row(link).transpose();
}

py::list effects_of(const Model& model) {
    py::list effects;
    for (const skeleton::EffectRecord& effect : model.effects) {
        py::dict numbers;
        for (const auto& parameter : effect.parameters) numbers[py::str(parameter.name)] = parameter.value;
        effects.append(py::dict(py::arg("name") = effect.name, py::arg("parameters") = numbers));
    }
    return effects;
}

SharedModel with_effect(const Model& model, const std::string& name, const py::dict& numbers) {
    auto changed = std::make_shared<Model>(model);
    std::erase_if(changed->effects, [&](const skeleton::EffectRecord& own) { return own.name == name; });
    skeleton::EffectRecord effect{name, {}};
    const skeleton::KnownEffect* known = skeleton::find_known_effect(name);
    for (const auto& [key, value] : numbers) {
        std::string unit;
        for (const auto& parameter : known ? known->parameters : std::vector<skeleton::KnownParameter>{})
            if (parameter.name == key.cast<std::string>()) unit = parameter.unit;
        effect.parameters.push_back({key.cast<std::string>(), value.cast<double>(), unit});
    }
    skeleton::make_physics(effect);  // which refuses what is missing, unknown or out of range
    changed->effects.push_back(std::move(effect));
    return changed;
}

template <typename T>
auto of_spheres(const T Sphere::*member) {
    return [member](const py::object& self) {
        const auto& spheres = self.cast<const Model&>().spheres;
        if constexpr (std::is_same_v<T, Vec3>)
            return view_of_members(spheres, spheres.empty() ? nullptr : (spheres.front().*member).data(), 3, self);
        else
            return view_of_members(spheres, spheres.empty() ? nullptr : &(spheres.front().*member), 0, self);
    };
}

}  // namespace

void bind_models(py::module_& module) {
    py::class_<Model, SharedModel>(
        module, "Model", "A body as spheres joined by elastic links, with a skin. `k` stiffnesses a link: 3, or 6.")
        .def_static(
            "read", [](const fs::path& file) { return std::make_shared<Model>(skeleton::read_model(file)); },
            py::arg("file"), "Reads a model.json.")
        .def(
            "write",
            [](const Model& m, const fs::path& file, bool force) {
                pipeline::commands::refuse_to_overwrite(file, force);
                skeleton::write_model(file, m);
            },
            py::arg("file"), py::arg("force") = false, "Writes a model.json.")
        .def_property_readonly(
            "name", [](const Model& m) { return m.name; }, "of the body")
        .def_property_readonly(
            "law", [](const Model& m) { return skeleton::law_names[static_cast<int>(m.law)]; },
            "'linear' or 'large-rotation'")
        .def_property_readonly("centers", of_spheres(&Sphere::center), "of the spheres at rest: (spheres, 3) [mm]")
        .def_property_readonly("radii", of_spheres(&Sphere::radius), "(spheres,) [mm]")
        .def_property_readonly("masses", of_spheres(&Sphere::mass), "(spheres,) [tonne]")
        .def_property_readonly("held", of_spheres(&Sphere::held), "does it stand in a support? (spheres,)")
        .def_property_readonly("volume_stiffness", of_spheres(&Sphere::volume),
                               "against changes of a sphere's share of the body: (spheres,) [MPa]; 0: none")
        .def_property_readonly(
            "links",
            [](const py::object& self) {
                const auto& links = self.cast<const Model&>().links;
                const int none[2] = {0, 0};
                const int* a = links.empty() ? none : &links.front().a;
                const int* b = links.empty() ? none + 1 : &links.front().b;
                return view(a, {std::ssize(links), 2}, {sizeof(Link), (b - a) * py::ssize_t{sizeof(int)}}, self);
            },
            "the spheres that each joins (links, 2)")
        .def_property_readonly(
            "lengths",
            [](const py::object& self) {
                const auto& links = self.cast<const Model&>().links;
                return view_of_members(links, links.empty() ? nullptr : &links.front().length, 0, self);
            },
            "at rest (links,) [mm]")
        .def_property(
            "stiffness",
            [](const py::object& self) {
                const auto& model = self.cast<const Model&>();
                return view_of_members(model.links,
                                       model.links.empty() ? nullptr : model.links.front().stiffness.data(),
                                       kinds_of(model), self);
            },
            &set_stiffness,
            "(links, k), in the order of stiffness_names [stiffness_units]; assign an array to change it")
        .def_property_readonly(
            "stiffness_names",
            [](const Model& m) {
                return std::vector<std::string>(skeleton::stiffness_names.begin(),
                                                skeleton::stiffness_names.begin() + kinds_of(m));
            },
            "of a link's stiffnesses (k,)")
        .def_property_readonly(
            "stiffness_units",
            [](const Model& m) {
                return std::vector<std::string>(skeleton::stiffness_units.begin(),
                                                skeleton::stiffness_units.begin() + kinds_of(m));
            },
            "of a link's stiffnesses (k,)")
        .def_property_readonly(
            "surface", [](const Model& m) { return std::make_shared<mesh::Surface>(m.surface); },
            "the skin at rest, a copy")
        .def_property_readonly("effects", &effects_of, "that are in force: [{'name', 'parameters'}], in our units")
        .def_property_readonly(
            "provenance", [](const Model& m) { return m.provenance; }, "where it comes from, in words")
        .def("_with_effect", &with_effect)
        .def(
            "copy", [](const Model& m) { return std::make_shared<Model>(m); }, "Another model, equal.");
}

}  // namespace palpate::python
