// Batch for Python: arrays in, arrays out.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/motion/gait.h"
#include "python/src/arguments.h"
#include "python/src/batch.h"
#include "sim/body/description/robot_model.h"
#include "tools/base/paths.h"

namespace kaz::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Robots = Locked<Batch>;

std::unique_ptr<Robots> make(const py::kwargs& given) {
  py::dict arguments(given);
  BatchOptions options;
  options.robots = take<int>(arguments, "robots", 1);
  options.threads = take<int>(arguments, "threads", 1);
  options.engine = named("engine", take<std::string>(arguments, "engine", "native"), kEngines);
  options.period_ms =
      static_cast<int>(std::lround(1000 * take<double>(arguments, "period_s", 0.02)));
  options.settle_ms =
      static_cast<int>(std::lround(1000 * take<double>(arguments, "settle_s", 0.3)));
  if (options.settle_ms < 10 || options.settle_ms > 10'000)
    raise({Fault::usage, "settle_s: must be 0.01 to 10 s"});
  options.kp_per_rad = take<double>(arguments, "kp", options.kp_per_rad);
  options.kd_s_per_rad = take<double>(arguments, "kd", options.kd_s_per_rad);
  const auto posture =
      take<std::vector<double>>(arguments, "posture", std::vector<double>(KZ_JOINTS));
  if (posture.size() != KZ_JOINTS)
    raise({Fault::usage, "posture: give " + std::to_string(KZ_JOINTS) + " angles in rad"});
  std::ranges::copy(posture, options.posture.begin());
  options.pictures = take<bool>(arguments, "pictures", false);
  const tools::BackendOptions backend = take_world_arguments(arguments);
  nothing_left("Batch", arguments);

  sim::SimulationOptions& simulation = options.simulation;
  simulation = sim::SimulationOptions(backend);
  simulation.seed = sim::RobotOptions{}.seed;  // seed of the common start
  simulation.world_path = value_of(tools::world_file(backend.world));
  simulation.robot_path = backend.robot_file.empty()
                              ? value_of(tools::data_file("robot/kaz/kaz.urdf"))
                              : backend.robot_file;
  simulation.camera_path = value_of(tools::data_file("robot/kaz/camera.json"));
  if (options.engine == Engine::h8)
    simulation.image_path = value_of(tools::firmware_image(backend.image));
  return std::make_unique<Robots>("this Batch",
                                  value_of(released([&] { return Batch::create(options); })));
}

py::array_t<double> table(const std::vector<double>& values, int columns) {
  return py::array_t<double>(
      {static_cast<py::ssize_t>(values.size()) / columns, static_cast<py::ssize_t>(columns)},
      values.data());
}

py::dict state_of(Robots& robots) {
  const BatchState state = robots.alone([](Batch& batch) { return batch.state(); });
  py::dict all;
  all["measured"] = table(state.measured, KZ_JOINTS);
  all["inertial"] = table(state.inertial, 3);
  all["trunk"] = table(state.trunk, 7);
  all["ball"] = table(state.ball, 3);
  all["off"] =
      py::array_t<std::uint8_t>(static_cast<py::ssize_t>(state.off.size()), state.off.data())
          .attr("astype")("bool");
  if (!state.picture_age.empty()) all["picture_age"] = array_of(state.picture_age);
  return all;
}

// Robots x left and right x height x width x 3: one copy, since each robot's pair has memory of its own.
// Black until the first pair has arrived.
py::array_t<std::uint8_t> pictures_of(Robots& robots) {
  const auto [count, camera] = robots.alone([](Batch& batch) {
    return std::pair(batch.options().pictures ? batch.options().robots : 0, batch.camera());
  });
  if (count == 0) raise({Fault::usage, "this Batch has no pictures: make it with pictures=True"});
  py::array_t<std::uint8_t> all({count, 2, camera.height, camera.width, 3});
  std::uint8_t* to = all.mutable_data();
  const auto bytes = static_cast<std::size_t>(3 * camera.width * camera.height);
  robots.alone([&, robots_ = static_cast<std::size_t>(count)](Batch& batch) {
    for (std::size_t i = 0; i < robots_; ++i) {
      const vision::StereoImages* const pair = batch.pictures(i);
      for (const bool right : {false, true}) {
        if (pair != nullptr)
          std::memcpy(to, (right ? pair->right : pair->left).rgb.data(), bytes);
        else
          std::memset(to, 0, bytes);
        to += bytes;
      }
    }
  });
  return all;
}

int count_of(Robots& robots) {
  return robots.alone([](Batch& batch) { return batch.options().robots; });
}

void reset(Robots& robots, const std::vector<std::optional<std::uint64_t>>& seeds) {
  if (static_cast<int>(seeds.size()) != count_of(robots))
    raise({Fault::usage, "reset: give a seed, or None, for each robot"});
  value_of(robots.alone([&](Batch& batch) { return batch.reset(seeds); }));
}

void step(Robots& robots, const Numbers& targets,
          const py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>& resting) {
  const int count = count_of(robots);
  if (targets.ndim() != 2 || targets.shape(0) != count || targets.shape(1) != KZ_JOINTS)
    raise({Fault::usage, "step: targets must be an array of " + std::to_string(count) + " x " +
                             std::to_string(KZ_JOINTS) + " angles in rad"});
  if (resting.ndim() != 1 || resting.shape(0) != count)
    raise({Fault::usage, "step: `resting` must have a flag for each robot"});
  // Copies: without the GIL another thread may write into the arrays.
  const std::vector<double> angles(targets.data(), targets.data() + targets.size());
  const std::vector<std::uint8_t> flags(resting.data(), resting.data() + resting.size());
  if (!std::ranges::all_of(angles, [](double x) { return std::isfinite(x); }))
    raise({Fault::usage, "step: targets must be finite"});
  value_of(robots.alone([&](Batch& batch) { return batch.step(angles, flags); }));
  check_signals();
}

}  // namespace

void add_environment(py::module_& module) {
  module.attr("HOME") = py::tuple(py::cast(motion::home()));  // by joint, rad
  py::class_<Robots>(module, "Batch")
      .def(py::init(&make))
      .def("reset", &reset, py::arg("seeds"))
      .def("step", &step, py::arg("targets").none(false), py::arg("resting").none(false))
      .def("state", &state_of)
      .def("pictures", &pictures_of)
      .def_property_readonly(
          "camera",
          [](Robots& robots) { return robots.alone([](Batch& batch) { return batch.camera(); }); })
      .def(
          "push",
          [](Robots& robots, int robot, const std::string& link,
             const std::array<double, 3>& impulse) {
            const Eigen::Vector3d vector(impulse.data());
            if (!vector.allFinite()) raise({Fault::usage, "push: the impulse must be finite"});
            value_of(robots.alone([&](Batch& batch) { return batch.push(robot, link, vector); }));
          },
          py::arg("robot"), py::arg("link"), py::arg("impulse"))
      .def(
          "accelerate",
          [](Robots& robots, int robot, const std::string& model,
             const std::array<double, 3>& change) {
            const Eigen::Vector3d vector(change.data());
            if (!vector.allFinite())
              raise({Fault::usage, "accelerate: the change of velocity must be finite"});
            value_of(
                robots.alone([&](Batch& batch) { return batch.accelerate(robot, model, vector); }));
          },
          py::arg("robot"), py::arg("model"), py::arg("change"))
      .def(
          "link_pose",
          [](Robots& robots, int robot, const std::string& link) {
            return matrix_of(
                value_of(robots.alone([&](Batch& batch) { return batch.link_pose(robot, link); })));
          },
          py::arg("robot"), py::arg("link"));
}

}  // namespace kaz::python
