// Keyword arguments, taken one by one so that the unknown ones can be named.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/arguments.h"

#include "sim/board/sensor_file.h"
#include "sim/runtime/simulation/step_ratio.h"

namespace kaz::python {

tools::BackendOptions take_world_arguments(py::dict& arguments) {
  tools::BackendOptions options;
  const auto text = [&](const char* name, const std::string& otherwise) {
    if (arguments.contains(name) && py::hasattr(arguments[name], "__fspath__"))
      arguments[name] = arguments[name].attr("__fspath__")();
    return take<std::string>(arguments, name, otherwise);
  };
  options.world = text("world", options.world);
  options.robot_file = text("robot_file", "");
  options.mcu = named("mcu", text("mcu", to_string(options.mcu)), sim::kMcuKinds);
  options.image = text("image", "");
  options.seed = take<std::uint64_t>(arguments, "seed", options.seed);
  options.eyes = named("eyes", text("eyes", to_string(options.eyes)), sim::kEyeKinds);
  options.eye_width = take<int>(arguments, "eye_width", 0);
  if (options.eye_width != 0 && options.eye_width != 320 && options.eye_width != 640)
    raise(
        {Fault::usage, "eye_width " + std::to_string(options.eye_width) + ": must be 320 or 640"});
  options.renderer =
      named("renderer", text("renderer", to_string(options.renderer)), sim::kRendererKinds);
  options.sensors = named("sensors", text("sensors", to_string(options.sensors)), sim::kSensorSets);
  options.dynamics = text("dynamics", options.dynamics);
  options.physics_step_ms = take<double>(arguments, "physics_step_ms", options.physics_step_ms);
  options.supply_volts = take<double>(arguments, "supply_volts", options.supply_volts);
  if (!(options.supply_volts >= tools::kMinSupply_v && options.supply_volts <= tools::kMaxSupply_v))
    raise({Fault::usage, "supply_volts: must be 1 to 20 V"});
  options.suspended = take<bool>(arguments, "suspended", false);
  options.imu = take<bool>(arguments, "imu", false);
  options.faults = text("faults", "");
  return options;
}

void nothing_left(const std::string& function, const py::dict& arguments) {
  for (const auto& [name, value] : arguments)
    throw py::type_error(function + "() has no argument '" + std::string(py::str(name)) + "'");
}

}  // namespace kaz::python
