// The simulated robot: world, emulated board, eyes; time passes in step() alone.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/simulation.h"

#include <algorithm>
#include <cmath>

#include "python/src/arguments.h"
#include "shared/faults/faults.h"
#include "sim/body/description/robot_model.h"
#include "sim/render/camera.h"
#include "sim/runtime/time.h"
#include "tools/base/paths.h"
#include "tools/run/backend.h"

namespace kaz::python {
namespace {

constexpr std::int64_t kMillisecondsBetweenSignals = 200;

// Steps of a millisecond; Ctrl-C and a robot's stop() end them.
void step(SimulatedWorld& world, double seconds) {
  if (!(seconds >= 0.001 && seconds <= 1e6))
    raise({Fault::usage, "step: seconds must be 0.001 to 1e6"});
  auto left = static_cast<std::int64_t>(std::llround(seconds * 1000));
  LockedCall call(world.lock());
  while (left > 0) {
    const std::int64_t now = std::min(left, kMillisecondsBetweenSignals);
    value_of(call.piece([&]() -> Result<void> {
      for (std::int64_t i = 0; i < now; ++i) {
        if (world.lock().interrupt().ends_waiting())
          return tl::unexpected(host::Interrupt::error());
        KAZ_TRY(world.object().step());
      }
      return {};
    }));
    left -= now;
    check_signals();
  }
}

py::dict joints_of(SimulatedWorld& world) {
  const auto joints = world.alone([](sim::Simulation& simulation) {
    const auto now = simulation.world().joints();
    return std::vector<sim::JointState>(now.begin(), now.end());
  });
  const auto column = [&](double sim::JointState::*field) {
    std::vector<double> values;
    for (const sim::JointState& joint : joints) values.push_back(joint.*field);
    return array_of(values);
  };
  py::dict all;
  all["angle"] = column(&sim::JointState::angle);
  all["velocity"] = column(&sim::JointState::velocity);
  all["torque"] = column(&sim::JointState::torque);
  all["current"] = column(&sim::JointState::current);
  all["winding_celsius"] = column(&sim::JointState::winding_celsius);
  return all;
}

py::list contacts_of(SimulatedWorld& world) {
  const auto contacts = world.alone([](sim::Simulation& simulation) {
    const auto now = simulation.world().contacts();
    return std::vector<sim::ContactPoint>(now.begin(), now.end());
  });
  py::list all;
  for (const sim::ContactPoint& point : contacts) {
    py::dict one;
    one["a"] = point.a;
    one["b"] = point.b;
    one["at"] = vector_of(point.at);
    one["force"] = vector_of(point.force);
    all.append(one);
  }
  return all;
}

py::array_t<double> link_pose(SimulatedWorld& world, const std::string& link) {
  const std::vector<std::string>& names = world.links();
  if (std::ranges::find(names, link) == names.end()) {
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    raise({Fault::usage, "link '" + link + "': must be one of " + known});
  }
  return matrix_of(
      world.alone([&](sim::Simulation& simulation) { return simulation.world().link_pose(link); }));
}

std::vector<Pair> pairs(SimulatedWorld& world) {
  return value_of(world.alone([](sim::Simulation& simulation) -> Result<std::vector<Pair>> {
    if (!simulation.has_eyes()) return tl::unexpected(sim::Simulation::no_eyes());
    simulation.open_eyes();
    std::vector<Pair> all;
    while (auto pair = simulation.next_pair()) all.push_back(pair_of(*pair));
    return all;
  }));
}

py::array picture(SimulatedWorld& world, const std::array<double, 3>& from,
                  const std::array<double, 3>& at, int width, int height, double view_rad) {
  if (width < 16 || height < 16 || width > 4096 || height > 4096)
    raise({Fault::usage, "picture: width and height must be 16 to 4096 pixels"});
  if (!(view_rad > 0.01 && view_rad < 3.0))
    raise({Fault::usage, "picture: view_rad, the horizontal field of view, must be 0.01 to 3 rad"});
  const Eigen::Vector3d eye(from.data()), target(at.data());
  if (!eye.allFinite() || !target.allFinite() || (target - eye).head<2>().norm() < 1e-6)
    raise({Fault::usage,
           "picture: `from_` and `at` must be finite positions in m, and must differ in x or y, "
           "because the camera cannot look straight up or down"});
  sim::View view;
  view.camera = sim::camera_of_view(width, height, view_rad);
  view.world_from_optical = sim::look_at(eye, target);
  view.samples_per_axis = 2;
  auto drawn = value_of(world.alone([&](sim::Simulation& simulation) {
    return simulation.picture(view, simulation.world().pose());
  }));
  auto* const kept = new std::vector<std::uint8_t>(std::move(drawn.rgb));
  py::capsule owner(kept, [](void* held) { delete static_cast<std::vector<std::uint8_t>*>(held); });
  return py::array_t<std::uint8_t>({height, width, 3}, kept->data(), owner);
}

std::span<const std::uint8_t> bytes_of(const py::bytes& bytes) {
  const std::string_view text = bytes;
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::shared_ptr<SimulatedWorld> make(const py::kwargs& given) {
  py::dict arguments(given);
  tools::BackendOptions options = take_world_arguments(arguments);
  options.recording = take<std::string>(arguments, "recording", "");
  options.record_pictures = take<bool>(arguments, "record_pictures", false);
  nothing_left("Simulation", arguments);
  auto simulation = value_of(released([&]() -> Result<std::unique_ptr<sim::Simulation>> {
    KAZ_TRY(tools::check(options));
    return tools::make_simulation(options, sim::FramePolicy::wait);
  }));
  simulation->world().watch_contacts(true);
  const auto robot = value_of(sim::load_robot(options.robot_file.empty()
                                                  ? value_of(tools::data_file("robot/kaz/kaz.urdf"))
                                                  : options.robot_file,
                                              {.body = false}));
  std::vector<std::string> links;
  for (const auto& [name, frame] : robot.frames) links.push_back(name);
  return std::make_shared<SimulatedWorld>(std::move(simulation), std::move(links));
}

void add_fault(SimulatedWorld& world, const std::string& line) {
  value_of(world.alone([&](sim::Simulation& simulation) -> Result<void> {
    simulation.add_fault(KAZ_TRY(faults::parse(line, simulation.time())));
    return {};
  }));
}

}  // namespace

void add_simulation(py::module_& module) {
  using World = SimulatedWorld;
  using sim::Simulation;
  py::class_<World, std::shared_ptr<World>> made(module, "Simulation");
  made.def(py::init(&make))
      .def("step", &step, py::arg("seconds") = 0.001)
      .def_property_readonly(
          "time", [](World& w) { return w.alone([](Simulation& s) { return seconds(s.time()); }); })
      .def_property_readonly("joint_names",
                             [](World& w) {
                               return w.alone([](Simulation& s) {
                                 const auto names = s.world().joint_order();
                                 return std::vector<std::string>(names.begin(), names.end());
                               });
                             })
      .def_property_readonly("link_names", [](World& w) { return w.links(); })
      .def("joints", &joints_of)
      .def("link_pose", &link_pose, py::arg("link"))
      .def(
          "object_position",
          [](World& w, const std::string& model) {
            return vector_of(
                value_of(w.alone([&](Simulation& s) { return s.world().object_position(model); })));
          },
          py::arg("model"))
      .def("contacts", &contacts_of)
      .def(
          "push",
          [](World& w, const std::string& link, const std::array<double, 3>& impulse) {
            const Eigen::Vector3d vector(impulse.data());
            if (!vector.allFinite()) raise({Fault::usage, "push: the impulse must be finite"});
            value_of(w.alone([&](Simulation& s) { return s.world().push(link, vector); }));
          },
          py::arg("link"), py::arg("impulse"))
      .def_property_readonly(
          "supply_volts",
          [](World& w) { return w.alone([](Simulation& s) { return s.board().supply_volts(); }); })
      .def_property_readonly(
          "supply_amperes",
          [](World& w) {
            return w.alone([](Simulation& s) { return s.world().supply_current_a(); });
          })
      .def_property_readonly(
          "motors_enabled",
          [](World& w) {
            return w.alone([](Simulation& s) { return s.board().drivers_enabled(); });
          })
      .def("pairs", &pairs)
      .def_property_readonly(
          "camera",
          [](World& w) { return w.alone([](Simulation& s) { return s.camera().model(); }); })
      .def("picture", &picture, py::arg("from_"), py::arg("at"), py::arg("width") = 640,
           py::arg("height") = 480, py::arg("view_rad") = 0.9)
      .def("add_fault", &add_fault, py::arg("line"))
      .def("clear_faults", [](World& w) { w.alone([](Simulation& s) { s.clear_faults(); }); })
      .def("save",
           [](World& w) {
             const auto state = value_of(w.alone([](Simulation& s) { return s.save(); }));
             return py::bytes(reinterpret_cast<const char*>(state.data()), state.size());
           })
      .def(
          "restore",
          [](World& w, const py::bytes& state) {
            const auto bytes = bytes_of(state);
            value_of(w.alone([&](Simulation& s) { return s.restore(bytes); }));
          },
          py::arg("state"))
      .def(
          "write",
          [](World& w, const py::bytes& given) {
            const auto bytes = bytes_of(given);
            w.alone([&](Simulation& s) { s.write(bytes); });
          },
          py::arg("bytes"))
      .def(
          "read",
          [](World& w, std::size_t most) {
            std::vector<std::uint8_t> some(std::min<std::size_t>(most, 1 << 20));
            const std::size_t count = w.alone([&](Simulation& s) { return s.read(some); });
            return py::bytes(reinterpret_cast<const char*>(some.data()), count);
          },
          py::arg("most") = 4096)
      .def(
          "start_recording",
          [](World& w, const std::string& path) {
            value_of(w.alone([&](Simulation& s) { return s.start_recording(path); }));
          },
          py::arg("path"))
      .def("finish_recording", [](World& w) {
        return value_of(w.alone([](Simulation& s) { return s.finish_recording(); }));
      });
}

}  // namespace kaz::python
