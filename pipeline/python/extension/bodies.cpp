#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>

#include "mesh/errors.h"
#include "pipeline/python/extension/bind.h"
#include "pipeline/python/extension/conversions/arrays.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/runtime/body.h"

// The model, alive. Its calls are short: what surrounds them counts.

namespace palpate::python {
namespace {

namespace fs = std::filesystem;

class OpenBody {
public:
    OpenBody(const skeleton::Model& model, int contacts, std::optional<double> damping_ratio)
        : body_(std::make_shared<runtime::Body>(
              model, runtime::BodyOptions{.damping_ratio = damping_ratio, .contacts = contacts})),
          centers_(body_->sphere_count(), 3) {}

    /// The body, for one call of one thread. Closing it meanwhile, by another thread, does not take it away.
    class Use {
    public:
        explicit Use(OpenBody& body) : body_(body), held_(body.body_) {
            if (!held_) throw py::value_error("the body is closed; make another one of the model");
            if (body.busy_.exchange(true, std::memory_order_acquire))
                throw std::runtime_error("the body is in use by another thread; give each thread a body of its own");
        }
        ~Use() { body_.busy_.store(false, std::memory_order_release); }
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;
        runtime::Body* operator->() const { return held_.get(); }

    private:
        OpenBody& body_;
        const std::shared_ptr<runtime::Body> held_;
    };

    /// Arrays keep its memory alive.
    void close() { body_.reset(); }
    bool closed() const { return body_ == nullptr; }
    const std::shared_ptr<runtime::Body>& shared() const { return body_; }
    Points& centers() { return centers_; }

private:
    std::shared_ptr<runtime::Body> body_;
    Points centers_;  // as last asked for
    std::atomic<bool> busy_ = false;
};

py::array_t<double> array_of(const Eigen::Vector3d& v) { return py::array_t<double>(3, v.data()); }

/// Memory of a body as an array that keeps the body alive.
template <typename T>
py::array lasting(const std::shared_ptr<runtime::Body>& body, const std::vector<T>& values) {
    const py::capsule owner(new std::shared_ptr<runtime::Body>(body),
                            [](void* p) { delete static_cast<std::shared_ptr<runtime::Body>*>(p); });
    constexpr auto size = static_cast<py::ssize_t>(sizeof(T));
    return view(values.data(), {std::ssize(values) / 3, 3}, {3 * size, size}, owner);
}

py::array skin(OpenBody& self) {
    const OpenBody::Use body(self);
    return lasting(self.shared(), body->skin());
}

py::array triangles(OpenBody& self) {
    const OpenBody::Use body(self);
    return lasting(self.shared(), body->triangles());
}

py::array positions(const py::object& object) {
    auto& self = object.cast<OpenBody&>();
    const OpenBody::Use body(self);
    for (int i = 0; i < body->sphere_count(); ++i) self.centers().row(i) = body->position(i).transpose();
    return view(self.centers(), object);
}

void step(OpenBody& self, double h, bool is_explicit, int steps) {
    if (steps < 0) throw InvalidInput("steps: is " + std::to_string(steps) + ", must be at least 0");
    const OpenBody::Use body(self);
    const py::gil_scoped_release released;
    if (is_explicit) {
        body->step_explicit(h, steps);
        return;
    }
    for (int i = 0; i < steps; ++i) body->step_implicit(h);
}

/// One turn of a control loop in one call: hands go to where they are to be, time goes on, forces come back.
py::array_t<double> drag_and_step(OpenBody& self, const std::vector<int>& contacts, const py::object& to,
                                  double stiffness, double h) {
    const Points targets = points_of(to, "to");
    if (targets.rows() != std::ssize(contacts))
        throw InvalidInput("to: has " + std::to_string(targets.rows()) + " rows, must have one for each of the " +
                           std::to_string(contacts.size()) + " contacts");
    Points forces(targets.rows(), 3);
    const OpenBody::Use body(self);
    {
        const py::gil_scoped_release released;
        for (Eigen::Index i = 0; i < targets.rows(); ++i)
            body->drag(contacts[static_cast<std::size_t>(i)], targets.row(i).transpose(), stiffness);
        body->step_implicit(h);
        for (Eigen::Index i = 0; i < targets.rows(); ++i)
            forces.row(i) = body->force(contacts[static_cast<std::size_t>(i)]).transpose();
    }
    return py::array_t<double>({forces.rows(), forces.cols()}, forces.data());
}

}  // namespace

void bind_bodies(py::module_& module) {
    using Use = OpenBody::Use;
    py::class_<OpenBody>(
        module, "Body",
        "A model, alive: forces or positions in, forces and the skin out, at haptic rates [mm, N, s]. One "
        "thread at a time; `with` closes it.")
        .def(py::init<const skeleton::Model&, int, std::optional<double>>(), py::arg("model"), py::arg("contacts") = 8,
             py::arg("damping_ratio") = py::none(),
             "contacts: most at a time, 0 to 64. damping_ratio: of the softest mode; None: the model's, or 0.1.")
        .def(py::init([](const fs::path& model, int contacts, std::optional<double> damping_ratio) {
                 return std::make_unique<OpenBody>(skeleton::read_model(model), contacts, damping_ratio);
             }),
             py::arg("model"), py::arg("contacts") = 8, py::arg("damping_ratio") = py::none())
        .def("close", &OpenBody::close, "Gives it back; arrays of it stay as they are.")
        .def_property_readonly("closed", &OpenBody::closed, "Was it given back?")
        .def("__enter__", [](py::object self) { return self; })
        .def("__exit__", [](OpenBody& self, const py::args&) { self.close(); })
        .def_property_readonly(
            "notices", [](OpenBody& self) { return Use(self)->notices(); },
            "what of the model is not played as it stands")
        .def_property_readonly("positions", &positions,
                               "of the spheres: (spheres, 3) [mm]; the array follows when it is asked for again")
        .def_property_readonly("skin", &skin,
                               "(vertices, 3) [mm], in single precision; the array follows when it is asked for again")
        .def_property_readonly("triangles", &triangles, "of the skin (m, 3)")
        .def(
            "reset", [](OpenBody& self) { Use(self)->reset(); }, "Back to rest, without contacts.")
        .def(
            "set_gravity", [](OpenBody& self, const py::object& g) { Use(self)->set_gravity(vector_of(g, "g")); },
            py::arg("g"), "Beside the model's effects (3) [mm/s^2].")
        .def(
            "touch",
            [](OpenBody& self, const py::object& point, double radius) {
                return Use(self)->touch(vector_of(point, "point"), radius);
            },
            py::arg("point"), py::arg("radius") = 0.0,
            "Takes hold of the skin nearest to a point, over a radius [mm]; the contact's number.")
        .def(
            "release", [](OpenBody& self, int contact) { Use(self)->release(contact); }, py::arg("contact"), "Lets go.")
        .def(
            "push",
            [](OpenBody& self, int contact, const py::object& force) {
                Use(self)->push(contact, vector_of(force, "force"));
            },
            py::arg("contact"), py::arg("force"), "A force on a contact (3) [N], until another is told.")
        .def(
            "drag",
            [](OpenBody& self, int contact, const py::object& to, double stiffness) {
                Use(self)->drag(contact, vector_of(to, "to"), stiffness);
            },
            py::arg("contact"), py::arg("to"), py::arg("stiffness"),
            "A spring from a contact to where it shall be (3) [mm]; stiffness > 0 [N/mm].")
        .def(
            "force", [](OpenBody& self, int contact) { return array_of(Use(self)->force(contact)); },
            py::arg("contact"), "That acts on the body at a contact (3) [N].")
        .def(
            "place", [](OpenBody& self, int contact) { return array_of(Use(self)->place(contact)); },
            py::arg("contact"), "Of a contact, as it stands (3) [mm].")
        .def(
            "step", [](OpenBody& self, double h, int steps) { step(self, h, false, steps); }, py::arg("h"),
            py::arg("steps") = 1, "Implicit steps of h [s], stable at any h.")
        .def(
            "step_explicit", [](OpenBody& self, double h, int steps) { step(self, h, true, steps); }, py::arg("h"),
            py::arg("steps") = 1, "Explicit steps of h [s], at most stable_step.")
        .def("drag_and_step", &drag_and_step, py::arg("contacts"), py::arg("to"), py::arg("stiffness"), py::arg("h"),
             "Drags contacts to `to` (n, 3) [mm] by springs [N/mm], steps by h [s]; forces on the body (n, 3) [N].")
        .def_property_readonly(
            "stable_step", [](OpenBody& self) { return Use(self)->stable_step(); }, "the longest explicit step [s]")
        .def(
            "equilibrium",
            [](OpenBody& self) {
                const Use body(self);
                const py::gil_scoped_release released;
                body->equilibrium();
            },
            "To where all forces vanish, at once.")
        .def_property_readonly(
            "energy",
            [](OpenBody& self) {
                const runtime::Energy energy = Use(self)->energy();
                return py::make_tuple(energy.kinetic, energy.potential);
            },
            "kinetic, potential [N mm]");
}

}  // namespace palpate::python
