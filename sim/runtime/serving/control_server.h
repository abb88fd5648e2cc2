// The control socket: what a pty has no wires for. One request a line, one JSON object back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/faults/faults.h"
#include "sim/runtime/serving/unix_listener.h"
#include "vision/image/frame.h"

namespace kaz::sim {

// Turns one request into its reply. A request is a JSON object {"command": "power", "argument":
// "off"} or the plain words "power off". Replies have "ok"; if false, "error" says why.
// docs/simulator.md lists them.
class ControlCommands {
 public:
  struct Handlers {
    std::function<void()> reset;
    std::function<Result<void>(bool boot)> boot_pins;
    std::function<void(bool on)> power;
    std::function<Result<void>(bool in)> plug;
    std::function<nlohmann::ordered_json()> status;
    std::function<void(const faults::Fault& fault)> fault;
    std::function<void()> clear_faults;
    std::function<Time()> now;  // simulated
    // Of a motor stand: the rest of the line, to its reply without "ok". Empty: there is none.
    std::function<Result<nlohmann::ordered_json>(const std::string& line)> stand = nullptr;
  };
  explicit ControlCommands(Handlers handlers) : handlers_(std::move(handlers)) {}
  nlohmann::ordered_json answer(std::string_view line) const;

 private:
  nlohmann::ordered_json fault(const std::string& line) const;
  nlohmann::ordered_json run(const std::string& command, const std::string& argument) const;
  Handlers handlers_;
};

// Never waits: poll() takes what has come since the last call.
class ControlServer {
 public:
  static Result<std::unique_ptr<ControlServer>> open(const std::string& path,
                                                     ControlCommands commands);
  void poll();

 private:
  struct Client {
    Descriptor socket;
    std::string received, to_send;
    bool closing = false;  // after what is to be sent
  };

  ControlServer(std::unique_ptr<UnixListener> listener, ControlCommands commands)
      : listener_(std::move(listener)), commands_(std::move(commands)) {}
  bool serve(Client& client);  // false: it is gone

  std::unique_ptr<UnixListener> listener_;
  ControlCommands commands_;
  std::vector<Client> clients_;
};

}  // namespace kaz::sim
