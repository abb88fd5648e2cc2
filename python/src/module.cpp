// The Python module kaz._kaz: simulation, robot, vision, recordings, behaviors.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/python.h"

#include <exception>
#include <stdexcept>

#include "tools/base/version.h"

namespace kaz::python {
namespace {

// Held for the life of the process, as the module is.
PyObject* g_usage = nullptr;
PyObject* g_environment = nullptr;
PyObject* g_robot = nullptr;
PyObject* g_stopped = nullptr;

constexpr const char* kStopped = "stop() or close() was called while this call was running";

}  // namespace

void raise(const Error& error) {
  switch (error.fault) {
    case Fault::usage:
      PyErr_SetString(g_usage, error.message.c_str());
      break;
    case Fault::environment:
      PyErr_SetString(g_environment, error.message.c_str());
      break;
    case Fault::interrupted:
      PyErr_SetString(g_stopped, kStopped);
      break;
    case Fault::failed:
    default:
      PyErr_SetString(g_robot, error.message.c_str());
  }
  throw py::error_already_set();
}

const char* Stopped::what() const noexcept {
  return kStopped;
}

LockedCall::LockedCall(ObjectLock& lock) : call_(lock) {
  if (call_.state() == ObjectLock::Call::State::stopping) throw Stopped();
  if (call_.state() == ObjectLock::Call::State::in_use)
    throw std::runtime_error(
        lock.name() + " is in use by another thread: wait until the call of that thread returns");
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

py::array_t<double> array_of(std::span<const double> values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> matrix_of(const Eigen::Isometry3d& pose) {
  py::array_t<double> matrix({4, 4});
  auto to = matrix.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < 4; ++i) {
    for (py::ssize_t k = 0; k < 4; ++k) to(i, k) = pose.matrix()(i, k);
  }
  return matrix;
}

py::array_t<double> vector_of(const Eigen::Vector3d& vector) {
  return array_of({vector.data(), 3});
}

void add_errors(py::module_& module) {
  const auto add = [&module](const char* name, PyObject* base) {
    const std::string full = std::string("kaz.") + name;
    PyObject* const made = PyErr_NewException(full.c_str(), base, nullptr);
    if (made == nullptr) throw py::error_already_set();
    module.add_object(name, made);
    return made;
  };
  g_usage = add("UsageError", PyExc_ValueError);
  g_environment = add("EnvironmentFault", PyExc_OSError);
  g_robot = add("RobotError", PyExc_RuntimeError);
  g_stopped = add("Stopped", g_robot);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const Stopped& stopped) {
      PyErr_SetString(g_stopped, stopped.what());
    }
  });
}

}  // namespace kaz::python

PYBIND11_MODULE(_kaz, module) {
  using namespace kaz::python;
  module.attr("__version__") = kaz::tools::kVersion;
  add_errors(module);
  add_pictures(module);
  add_simulation(module);
  add_robot(module);
  add_vision(module);
  add_recording(module);
  add_behavior(module);
  add_environment(module);
}
