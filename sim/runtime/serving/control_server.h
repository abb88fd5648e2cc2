// Control socket for commands that cannot be sent through a pty: reset, mode pins, power, faults and status.
// Each request is one line. Each reply is one JSON object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/base/time.hpp"
#include "shared/faults/faults.h"
#include "sim/runtime/serving/unix_listener.h"

namespace kaz::sim {

// A parsed line of the control socket.
struct ControlRequest {
  std::string command, argument;
};
// Parses a JSON object {"command": "power", "argument": "off"} or plain text "power off". An error message
// states why the line is invalid.
Result<ControlRequest> parse_control_request(std::string_view line);

// Executes requests. A reply contains "ok". If "ok" is false, the reply also contains "error".
// docs/reference/simulator.md lists the commands.
class ControlCommands {
 public:
  struct Handlers {
    std::function<void()> reset;
    std::function<Result<void>(bool boot)> boot_pins;
    std::function<void(bool on)> power;
    std::function<Result<void>(bool in)> plug;
    std::function<nlohmann::ordered_json()> status;
    std::function<void()> watch_touches;
    std::function<void(const faults::Fault& fault)> fault;
    std::function<void()> clear_faults;
    std::function<Time()> now;  // simulated time
    // Executes a command of the motor stand. `line` is the text after the word `stand`. The returned object
    // does not contain "ok"; ControlCommands adds "ok". If the simulator has no motor stand, `stand` is null.
    std::function<Result<nlohmann::ordered_json>(const std::string& line)> stand = nullptr;
  };
  explicit ControlCommands(Handlers handlers) : handlers_(std::move(handlers)) {}
  // Executes one request and returns the reply.
  nlohmann::ordered_json answer(std::string_view line) const;

 private:
  nlohmann::ordered_json fault(const std::string& line) const;
  nlohmann::ordered_json run(const std::string& command, const std::string& argument) const;
  Handlers handlers_;
};

// Serves at most 8 clients. The server never blocks: poll() handles the requests that have arrived since the
// last call.
class ControlServer {
 public:
  // Executes one line and returns the reply.
  using Answer = std::function<nlohmann::ordered_json(std::string_view line)>;
  // Listens on a Unix socket at `path`. Returns the errors of UnixListener::open().
  static Result<std::unique_ptr<ControlServer>> open(const std::string& path, Answer answer);
  static Result<std::unique_ptr<ControlServer>> open(const std::string& path,
                                                     ControlCommands commands);
  void poll();

 private:
  struct Client {
    Descriptor socket;
    std::string received, to_send;
    bool closing = false;  // disconnects once `to_send` is sent
  };

  ControlServer(std::unique_ptr<UnixListener> listener, Answer answer)
      : listener_(std::move(listener)), answer_(std::move(answer)) {}
  bool serve(Client& client);  // returns false if the client has disconnected

  std::unique_ptr<UnixListener> listener_;
  Answer answer_;
  std::vector<Client> clients_;
};

}  // namespace kaz::sim
