// The keyword arguments of Simulation() and run_behavior() that say which world and which robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "python/src/python.h"
#include "tools/app/session/backend_options.h"

namespace kaz::python {

// Takes from `arguments` what it knows: world, robot_file, mcu, image, seed, eyes, eye_width, renderer,
// sensors, dynamics, physics_step_ms, supply_volts, suspended, imu, faults (a file). Raises UsageError for a
// wrong value.
tools::BackendOptions take_world_arguments(py::dict& arguments);
// Raises UsageError if something is left.
void nothing_left(const std::string& function, const py::dict& arguments);

// Removes and returns it; `otherwise` if it is not there. Raises TypeError for another type, and for None.
template <class T>
T take(py::dict& arguments, const char* name, T otherwise) {
  if (!arguments.contains(name)) return otherwise;
  const py::object value = arguments.attr("pop")(name);
  try {
    if (!value.is_none()) return value.cast<T>();
  } catch (const py::cast_error&) {
  }
  throw py::type_error(std::string(name) + "=" + std::string(py::repr(value)) +
                       " is of the wrong type: " + std::string(py::str(py::type::of(value))));
}

}  // namespace kaz::python
