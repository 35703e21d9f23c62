#include <fmt/format.h>
#include <pybind11/stl.h>

#include "identify/effects/catalogue.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"

// An effect defined by a Python function: for trying out, as each of its points takes the interpreter's lock.

namespace palpate::python {
namespace {

/// Definition of an effect in Python. Registered effects live as long as the program, longer than the interpreter: what
/// is Python's in them is never given back.
struct EffectDefinition {
    identify::EffectDescription description;
    std::vector<std::string> names, units;
    std::vector<double> prior_sd;
    fem::ActsOn acts_on = fem::ActsOn::surface;
    PyObject* terms = nullptr;  // callable(X, x, **numbers) -> (energy, gradient, hessian)
};

class PythonPotential : public fem::PointPotential {
public:
    PythonPotential(std::shared_ptr<const EffectDefinition> definition, std::vector<double> values)
        : definition_(std::move(definition)), values_(std::move(values)) {}

    fem::ActsOn acts_on() const override { return definition_->acts_on; }

    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        const py::gil_scoped_acquire held;
        py::dict numbers;
        for (std::size_t i = 0; i < values_.size(); ++i) numbers[py::str(definition_->names[i])] = values_[i];
        const auto returned = py::reinterpret_borrow<py::object>(definition_->terms)(
            py::array_t<double>(3, X.data()), py::array_t<double>(3, x.data()), **numbers);
        if (!py::isinstance<py::tuple>(returned) || py::len(returned) != 3)
            throw InvalidInput(
                fmt::format("effect '{}': its function must return (energy, gradient (3,), hessian (3, 3))",
                            definition_->description.name));
        const auto parts = returned.cast<py::tuple>();
        return {.energy = parts[0].cast<double>(),
                .gradient = vector_of(parts[1], "the effect's gradient"),
                .hessian = matrix_of(parts[2], "the effect's hessian", 3, 3)};
    }

private:
    std::shared_ptr<const EffectDefinition> definition_;
    std::vector<double> values_;
};

class PythonEffect : public identify::EffectHypothesis {
public:
    explicit PythonEffect(std::shared_ptr<const EffectDefinition> definition) : definition_(std::move(definition)) {}
    const identify::EffectDescription& description() const override { return definition_->description; }

    std::vector<identify::EffectNumber> numbers(const identify::BodyModel&, const identify::Problem&) const override {
        std::vector<identify::EffectNumber> numbers;
        for (std::size_t i = 0; i < definition_->names.size(); ++i)
            numbers.push_back(
                {.name = definition_->names[i], .unit = definition_->units[i], .prior_sd = definition_->prior_sd[i]});
        return numbers;
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.points.push_back(
            std::make_shared<PythonPotential>(definition_, std::vector<double>(values.begin(), values.end())));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        std::string text = fmt::format("'{}' is missing:", record.name);
        for (const auto& number : record.parameters)
            text += fmt::format(" {} = {:.3g} {}", number.name, number.value, number.unit);
        return text + ".";
    }

private:
    std::shared_ptr<const EffectDefinition> definition_;
};

fem::ActsOn acts_on(const std::string& word) {
    if (word == "material") return fem::ActsOn::material;
    if (word == "surface") return fem::ActsOn::surface;
    throw InvalidInput(fmt::format("acts_on: is '{}', must be 'material' (per mass) or 'surface' (per area)", word));
}

void register_python_effect(const std::string& name, const py::function& terms,
                            const std::vector<std::tuple<std::string, std::string, double>>& parameters,
                            const std::string& where, const std::string& meaning) {
    if (skeleton::find_known_effect(name) || identify::effect_named(name))
        throw InvalidInput(fmt::format("effect '{}' is known already; give yours another name", name));
    auto definition = std::make_shared<EffectDefinition>();
    definition->acts_on = acts_on(where);
    definition->description = {.name = name,
                               .kind = identify::EffectKind::body,
                               .meaning = meaning,
                               .parameters = {},
                               .reveals = "what its function in Python says",
                               .confused_with = {},
                               .separating_probe = "loads at other places and in other directions",
                               .next_probe = "load"};
    skeleton::KnownEffect known{name, {}, {}};
    for (const auto& [number, unit, prior_sd] : parameters) {
        if (!(prior_sd > 0))
            throw InvalidInput(
                fmt::format("effect '{}': the prior_sd of {} is {}, must be above 0", name, number, prior_sd));
        definition->names.push_back(number);
        definition->units.push_back(unit);
        definition->prior_sd.push_back(prior_sd);
        definition->description.parameters.push_back(fmt::format("{} [{}]", number, unit));
        known.parameters.push_back({number, unit});
    }
    definition->terms = terms.inc_ref().ptr();
    known.make = [definition](const skeleton::EffectNumbers& numbers) -> fem::Effects {
        std::vector<double> values;
        for (const std::string& number : definition->names) values.push_back(numbers[number]);
        return {.points = {std::make_shared<PythonPotential>(definition, std::move(values))}};
    };
    identify::register_effect(std::move(known), std::make_shared<PythonEffect>(definition));
}

}  // namespace

void bind_effects(py::module_& module) { module.def("register_effect", &register_python_effect); }

}  // namespace palpate::python
