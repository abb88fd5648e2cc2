// What the parts of the Python module share: errors as exceptions, arrays, names of joints.
// SPDX-License-Identifier: Apache-2.0
//
// Whatever takes longer than some microseconds runs without the GIL; arguments are checked before. So each
// object that a call changes has an ObjectLock, and all of its members go through LockedCall.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "python/src/object_lock.h"
#include "shared/base/result.hpp"
#include "vision/image/frame.h"

namespace kaz::python {

namespace py = pybind11;

// Throws a Python exception with the error's sentence: UsageError (a ValueError) for wrong values,
// EnvironmentFault (an OSError) for ports, files and the like, Stopped (a RobotError) for an interrupted
// call, RobotError for the rest.
[[noreturn]] void raise(const Error& error);

template <class T>
T value_of(Result<T> result) {
  if (!result) raise(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// Without the GIL.
template <class F>
auto released(F call) {
  const py::gil_scoped_release release;
  return call();
}

// A pending signal's exception (Ctrl-C), if there is one.
void check_signals();

// Becomes the Python exception kaz.Stopped.
struct Stopped final : std::exception {
  const char* what() const noexcept override;
};

// A call from Python on an object with a lock. Throws a RuntimeError if another thread's call is running on
// the object, Stopped if stop() or close() is.
class LockedCall {
 public:
  explicit LockedCall(ObjectLock& lock);

  // Runs `work` without the GIL, alone with the object. Throws Stopped if stop() or close() came before it.
  // The object is free again before the GIL is taken, so that stop() does not wait for the GIL.
  template <class F>
  auto piece(F work) {
    const py::gil_scoped_release release;
    const Inside inside(call_);
    return work();
  }

 private:
  struct Inside {
    explicit Inside(ObjectLock::Call& call_) : call(call_) {
      if (!call.enter()) throw Stopped();
    }
    ~Inside() { call.leave(); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
    ObjectLock::Call& call;
  };
  ObjectLock::Call call_;
};

// An object as Python has it, and its lock.
template <class T>
class Locked {
 public:
  Locked(const std::string& name, std::unique_ptr<T> object)
      : lock_(name), object_(std::move(object)) {}
  ObjectLock& lock() { return lock_; }
  // To be used in a piece of a LockedCall only.
  T& object() { return *object_; }

  // What `work` returns for the object; it must not use Python.
  template <class F>
  auto alone(F work) {
    return LockedCall(lock_).piece([&] { return work(*object_); });
  }

 private:
  ObjectLock lock_;
  std::unique_ptr<T> object_;
};

// A copy, so that it is the caller's.
py::array_t<double> array_of(std::span<const double> values);
// 4 x 4, homogeneous.
py::array_t<double> matrix_of(const Eigen::Isometry3d& pose);
py::array_t<double> vector_of(const Eigen::Vector3d& vector);

// A joint by its name or number.
using JointKey = std::variant<int, std::string>;

template <class Enum, std::size_t N>
Enum named(const char* what, const std::string& name, const std::array<Enum, N>& all) {
  std::string names;
  for (const Enum one : all) {
    if (name == to_string(one)) return one;
    names += (names.empty() ? "" : ", ") + std::string(to_string(one));
  }
  raise({Fault::usage, std::string(what) + " '" + name + "': give one of " + names});
}

// A pair of pictures as it reached the host. Arrays of it share its memory and are read-only.
struct Pair {
  vision::FrameInfo info;
  std::shared_ptr<const vision::StereoImages> images;
};
Pair pair_of(const vision::StereoPair& pair);

// Height x width x 3, RGB; copied.
vision::Image image_of(
    const py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>& picture);

void add_errors(py::module_& module);
void add_pictures(py::module_& module);
void add_simulation(py::module_& module);
void add_robot(py::module_& module);
void add_vision(py::module_& module);
void add_recording(py::module_& module);
void add_behavior(py::module_& module);
void add_environment(py::module_& module);

}  // namespace kaz::python
