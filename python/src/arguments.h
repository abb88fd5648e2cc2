// Parses the keyword arguments of Simulation() and run_behavior() that select world and robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "python/src/python.h"
#include "tools/run/backend_options.h"

namespace kaz::python {

// Removes the known options from `arguments`: those of BackendOptions::visit() that the command line has, and
// faults (a file). Raises UsageError for an invalid value.
tools::BackendOptions take_world_arguments(py::dict& arguments);
// Raises UsageError if `arguments` is not empty.
void nothing_left(const std::string& function, const py::dict& arguments);

// Removes and returns an argument. Returns `otherwise` if the argument is missing. Raises TypeError for None
// or a value of another type.
template <class T>
T take(py::dict& arguments, const char* name, T otherwise) {
  if (!arguments.contains(name)) return otherwise;
  const py::object value = arguments.attr("pop")(name);
  try {
    if (!value.is_none()) return value.cast<T>();
  } catch (const py::cast_error&) {
  }
  throw py::type_error(std::string(name) + "=" + std::string(py::repr(value)) +
                       " has the wrong type: " + std::string(py::str(py::type::of(value))));
}

}  // namespace kaz::python
