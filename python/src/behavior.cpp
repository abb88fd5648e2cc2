// A behavior from start to end, as `kaz run` has it.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/behavior.h"

#include <signal.h>

#include <array>

#include "host/behavior/plugin.h"
#include "python/src/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/run/run.h"

namespace kaz::python {
namespace {

// While it lives Ctrl-C and termination end a run as they end `kaz run`, its results kept; else they are
// Python's.
class SessionSignals {
 public:
  SessionSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], nullptr, &before_[i]);
    tools::catch_signals();
  }
  ~SessionSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
  SessionSignals(const SessionSignals&) = delete;
  SessionSignals& operator=(const SessionSignals&) = delete;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> before_{};
};

// Python's values of options, as the command line has them: True is "true", 3.5 is "3.5".
std::map<std::string, std::string> settings_of(const py::dict& given) {
  std::map<std::string, std::string> settings;
  for (const auto& [name, value] : given) {
    const std::string text = py::isinstance<py::bool_>(value)
                                 ? (value.cast<bool>() ? "true" : "false")
                                 : std::string(py::str(value));
    settings[std::string(py::str(name))] = text;
  }
  return settings;
}

// Stores the end of a run.
struct EndObserver final : tools::RunObserver {
  void ended(const Result<behavior::Outcome>& how, double duration_s, double) override {
    outcome = how;
    run_s = duration_s;
  }
  std::optional<Result<behavior::Outcome>> outcome;
  double run_s = 0;
};

py::dict run_behavior(const std::string& name, const py::kwargs& given) {
  if (behavior::names_plugin(name))
    raise({Fault::usage, "run_behavior: `" + name +
                             "` is a plug-in: run the plug-in with `kaz run " + name +
                             "`, or give a name from kaz.behaviors()"});
  py::dict arguments(given);
  tools::RunOptions run;
  const bool named = arguments.contains("world");
  run.backend = take_world_arguments(arguments);
  if (const auto known = behavior::find_behavior(name); known && !named)
    run.backend.world = known->world;
  run.behavior = name;
  run.settings = settings_of(take<py::dict>(arguments, "settings", py::dict()));
  if (const auto loaded = behavior::load_settings(name, run.settings); !loaded)
    raise(loaded.error());
  run.out = take<std::string>(arguments, "out", "");
  run.backend.robot = take<std::string>(arguments, "robot", "sim");
  run.backend.camera = take<std::string>(arguments, "camera", "sim");
  run.backend.calibration = take<std::string>(arguments, "calibration", "");
  run.backend.address = take<std::uint8_t>(arguments, "address", run.backend.address);
  run.backend.record_pictures = take<bool>(arguments, "record_pictures", false);
  nothing_left("run_behavior", arguments);
  run.quiet = true;
  run.json = true;  // no progress
  run.label = "kaz.run_behavior";
  run.backend.needs_camera = value_of(behavior::find_behavior(name)).needs_camera;

  EndObserver observer;
  // Signal handlers belong to the process. Never destroyed: a thread may be in a run when the process ends.
  static ObjectLock& lock = *new ObjectLock("kaz.run_behavior()");
  LockedCall call(lock);
  const auto result = [&] {
    const SessionSignals signals;
    return call.piece([&] { return tools::run(run, observer); });
  }();
  if (const int number = tools::received_signal(); number != 0) {
    tools::forget_signal();
    ::raise(number);  // to Python, whose handler says what it means
    check_signals();
  }
  if (!result && result.error().fault == Fault::interrupted) {
    PyErr_SetString(PyExc_KeyboardInterrupt, result.error().message.c_str());
    throw py::error_already_set();
  }
  if (!result) raise(result.error());

  py::dict report;
  report["success"] = *result;
  report["duration_s"] = observer.run_s;
  if (const auto& ended = observer.outcome; ended && *ended) {
    report["sentence"] = (*ended)->sentence;
    report["cause"] = (*ended)->cause;
    py::dict numbers;
    for (const auto& [what, number] : (*ended)->measurements) numbers[what.c_str()] = number;
    report["measurements"] = numbers;
  } else if (ended) {
    report["sentence"] = ended->error().message;
    report["cause"] = "error";
    report["measurements"] = py::dict();
  }
  return report;
}

py::dict behaviors() {
  py::dict all;
  for (const behavior::Behavior& one : behavior::behaviors()) {
    py::dict options;
    for (const behavior::Option& option : one.options)
      options[py::str(std::string(option.name))] = std::string(option.text);
    all[py::str(std::string(one.name))] = py::make_tuple(std::string(one.text), options);
  }
  return all;
}

}  // namespace

void add_behavior(py::module_& module) {
  module.def("run_behavior", &run_behavior, py::arg("name"));
  module.def("behaviors", &behaviors);
}

}  // namespace kaz::python
