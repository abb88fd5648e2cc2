// A behavior from start to end, as `kaz run` has it.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/behavior.h"

#include <signal.h>

#include <array>

#include "host/behavior/plugin.h"
#include "python/src/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/run/balance_setting.h"
#include "tools/run/session.h"

namespace kaz::python {
namespace {

// While it lives Ctrl-C and termination end a session as they end `kaz run`, its results kept; else they are
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

py::dict run_behavior(const std::string& name, const py::kwargs& given) {
  if (behavior::names_plugin(name))
    raise({Fault::usage, "run_behavior: `" + name +
                             "` is a plug-in: run the plug-in with `kaz run " + name +
                             "`, or give a name from kaz.behaviors()"});
  py::dict arguments(given);
  tools::SessionOptions session;
  const bool named = arguments.contains("world");
  session.backend = take_world_arguments(arguments);
  if (!named) session.backend.world = tools::usual_world(name);
  session.behavior = name;
  session.settings = settings_of(take<py::dict>(arguments, "settings", py::dict()));
  if (const auto loaded = tools::load_balance(name, session.settings); !loaded)
    raise(loaded.error());
  session.out = take<std::string>(arguments, "out", "");
  session.backend.robot = take<std::string>(arguments, "robot", "sim");
  session.backend.camera = take<std::string>(arguments, "camera", "sim");
  session.backend.calibration = take<std::string>(arguments, "calibration", "");
  session.backend.address = take<std::uint8_t>(arguments, "address", session.backend.address);
  session.backend.record_pictures = take<bool>(arguments, "record_pictures", false);
  nothing_left("run_behavior", arguments);
  session.quiet = true;
  session.json = true;  // no progress
  session.label = "kaz.run_behavior";
  session.backend.needs_camera = value_of(behavior::find_behavior(name)).needs_camera;

  std::optional<Result<behavior::Outcome>> ended;
  double duration_s = 0;
  session.on_end = [&](const Result<behavior::Outcome>& outcome, double run_s, double) {
    ended = outcome;
    duration_s = run_s;
  };
  // Signal handlers belong to the process. Never destroyed: a thread may be in a run when the process ends.
  static ObjectLock& lock = *new ObjectLock("kaz.run_behavior()");
  LockedCall call(lock);
  const auto result = [&] {
    const SessionSignals signals;
    return call.piece([&session] { return tools::run_session(session); });
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
  report["duration_s"] = duration_s;
  if (ended && *ended) {
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
