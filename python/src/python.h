// Common parts of the Python module: errors as exceptions, arrays, joint names.
// SPDX-License-Identifier: Apache-2.0
//
// Operations that take more than a few microseconds run without the GIL. Their arguments are checked before
// the GIL is released. Without the GIL, several threads could use one object at the same time. Therefore each
// object that a call changes has an ObjectLock, and all member functions of the object use LockedCall.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
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

// Throws a Python exception with the error's message. UsageError (a ValueError): invalid values.
// EnvironmentFault (an OSError): ports, files and similar. Stopped (a RobotError): an interrupted call.
// RobotError: all other errors.
[[noreturn]] void raise(const Error& error);

template <class T>
T value_of(Result<T> result) {
  if (!result) raise(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// Calls a function without the GIL.
template <class F>
auto released(F call) {
  const py::gil_scoped_release release;
  return call();
}

// Throws the exception of a pending signal (Ctrl-C), if any.
void check_signals();

// C++ exception that becomes the Python exception kaz.Stopped.
struct Stopped final : std::exception {
  const char* what() const noexcept override;
};

// A call from Python on an object with a lock. The constructor throws a RuntimeError if another thread's call
// is running on the object, and Stopped if stop() or close() is running.
class LockedCall {
 public:
  explicit LockedCall(ObjectLock& lock);

  // Runs `work` without the GIL. While `work` runs, no other thread works on the object. Throws Stopped if
  // stop() or close() was called before. The object is released before the GIL is taken, so that stop() does
  // not wait for the GIL.
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

// An object that Python owns, together with the object's lock.
template <class T>
class Locked {
 public:
  Locked(const std::string& name, std::unique_ptr<T> object)
      : lock_(name), object_(std::move(object)) {}
  ObjectLock& lock() { return lock_; }
  // Call object() only in a piece of a LockedCall.
  T& object() { return *object_; }

  // Runs `work` on the object without the GIL, and returns the result of `work`. While `work` runs, no other
  // thread works on the object. `work` must not use Python.
  template <class F>
  auto alone(F work) {
    return LockedCall(lock_).piece([&] { return work(*object_); });
  }

 private:
  ObjectLock lock_;
  std::unique_ptr<T> object_;
};

// Returns a copy that belongs to the caller.
py::array_t<double> array_of(std::span<const double> values);
// Returns a 4 x 4 homogeneous matrix.
py::array_t<double> matrix_of(const Eigen::Isometry3d& pose);
py::array_t<double> vector_of(const Eigen::Vector3d& vector);

// A joint, given by name or number.
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

// A pair of pictures as received by the host. NumPy arrays share the memory of the pictures and are
// read-only.
struct Pair {
  vision::FrameInfo info;
  std::shared_ptr<const vision::StereoImages> images;
};

// Waits for the pixels of a pair and returns the pictures.
Pair pair_of(const vision::StereoPair& pair);

// Copies an RGB array of height x width x 3 to an image.
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
