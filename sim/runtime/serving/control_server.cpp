// Commands of the control socket and their clients.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/control_server.h"
#include "shared/base/bounded_json.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <utility>

namespace kaz::sim {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxClients = 8;
constexpr std::size_t kLongestLine = 1024;
constexpr std::size_t kMaxUnsent = 65536;  // a client that does not read its replies is dropped

Json refusal(const std::string& why) {
  return {{"ok", false}, {"error", why}};
}

std::string line_of(const Json& reply) {
  // Errors quote the request, which may not be valid UTF-8.
  return reply.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Result<ControlRequest> parse_control_request(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return fail("empty request; send \"help\"");
  const auto last = line.find_last_not_of(" \t\r");
  line = line.substr(first, last - first + 1);

  if (line.front() != '{') {
    const auto space = line.find_first_of(" \t");
    if (space == std::string_view::npos) return ControlRequest{std::string(line), ""};
    const auto argument = line.find_first_not_of(" \t", space);
    return ControlRequest{std::string(line.substr(0, space)), std::string(line.substr(argument))};
  }
  const Json request = parse_bounded_json<Json>(line).value_or(nullptr);
  if (!request.is_object()) return fail("the request is not a JSON object");
  const auto text = [&request](const char* key) {
    const auto entry = request.find(key);
    return entry != request.end() && entry->is_string() ? entry->get<std::string>() : std::string();
  };
  return ControlRequest{text("command"), text("argument")};
}

Json ControlCommands::answer(std::string_view line) const {
  const auto request = parse_control_request(line);
  return request ? run(request->command, request->argument) : refusal(request.error().message);
}

Json ControlCommands::fault(const std::string& line) const {
  if (line == "none") {
    handlers_.clear_faults();
    return {{"ok", true}};
  }
  const auto fault = faults::parse(line, handlers_.now());
  if (!fault) return refusal(fault.error().message);
  handlers_.fault(*fault);
  return {{"ok", true}, {"fault", faults::text_of(*fault)}};
}

Json ControlCommands::run(const std::string& command, const std::string& argument) const {
  const bool with_argument = command == "power" || command == "fault" || command == "mode" ||
                             command == "plug" || command == "stand";
  if (!with_argument && !argument.empty())
    return refusal("\"" + command + "\" takes no argument, got \"" + argument + "\"");
  if (command == "help") {
    return {
        {"ok", true},
        {"commands",
         {{"help", "this list"},
          {"reset", "pulse the board's reset pin"},
          {"mode boot|run", "set the mode pins for the next reset"},
          {"power on|off", "switch the board's power"},
          {"plug out|in", "unplug or plug in the serial port"},
          {"stand LINE", "send a command to the motor stand; \"stand help\" lists the commands"},
          {"fault LINE", "inject a fault now or `at` a time; \"fault none\" ends all faults"},
          {"touches", "from now on, \"status\" also lists what the robot has touched"},
          {"status", "print time, mcu, power, host and losses"}}}};
  }
  if (command == "reset") {
    handlers_.reset();
    return {{"ok", true}};
  }
  if (command == "power") {
    if (argument != "on" && argument != "off")
      return refusal("\"power\" takes \"on\" or \"off\", got \"" + argument + "\"");
    handlers_.power(argument == "on");
    return {{"ok", true}};
  }
  if (command == "mode") {
    if (argument != "boot" && argument != "run")
      return refusal("\"mode\" takes \"boot\" or \"run\", got \"" + argument + "\"");
    if (auto set = handlers_.boot_pins(argument == "boot"); !set)
      return refusal(set.error().message);
    return {{"ok", true}};
  }
  if (command == "plug") {
    if (argument != "out" && argument != "in")
      return refusal("\"plug\" takes \"out\" or \"in\", got \"" + argument + "\"");
    if (auto done = handlers_.plug(argument == "in"); !done) return refusal(done.error().message);
    return {{"ok", true}};
  }
  if (command == "fault") return fault(argument);
  if (command == "stand") {
    if (!handlers_.stand)
      return refusal("this is a robot, not a motor stand; start `kaz sim --stand`");
    auto reply = handlers_.stand(argument);
    if (!reply) return refusal(reply.error().message);
    Json all{{"ok", true}};
    all.update(*reply);
    return all;
  }
  if (command == "touches") {
    handlers_.watch_touches();
    return {{"ok", true}};
  }
  if (command == "status") {
    Json reply{{"ok", true}};
    reply.update(handlers_.status());
    return reply;
  }
  return refusal("there is no command \"" + command + "\"; send \"help\"");
}

Result<std::unique_ptr<ControlServer>> ControlServer::open(const std::string& path, Answer answer) {
  auto listener = KAZ_TRY(UnixListener::open(path));
  return std::unique_ptr<ControlServer>(new ControlServer(std::move(listener), std::move(answer)));
}

Result<std::unique_ptr<ControlServer>> ControlServer::open(const std::string& path,
                                                           ControlCommands commands) {
  return open(path, [commands = std::move(commands)](std::string_view line) {
    return commands.answer(line);
  });
}

void ControlServer::poll() {
  while (Descriptor socket = listener_->accept()) {
    if (clients_.size() < kMaxClients) clients_.push_back({std::move(socket), "", "", false});
  }
  std::vector<Client> staying;
  for (Client& client : clients_) {
    if (serve(client)) staying.push_back(std::move(client));
  }
  clients_ = std::move(staying);
}

bool ControlServer::serve(Client& client) {
  char buffer[512];
  const ssize_t got = ::recv(client.socket.get(), buffer, sizeof buffer, 0);
  if (got < 0 && errno != EAGAIN && errno != EINTR) return false;
  if (got == 0) client.closing = true;
  if (got > 0) client.received.append(buffer, static_cast<std::size_t>(got));

  for (auto end = client.received.find('\n'); end != std::string::npos && end <= kLongestLine;
       end = client.received.find('\n')) {
    client.to_send += line_of(answer_(std::string_view(client.received).substr(0, end)));
    client.received.erase(0, end + 1);
  }
  if (client.received.find('\n') > kLongestLine && client.received.size() > kLongestLine) {
    client.to_send += line_of(refusal("a request has at most 1024 characters"));
    client.received.clear();
    client.closing = true;
  }
  if (client.to_send.size() > kMaxUnsent) return false;
  if (!client.to_send.empty()) {
    const ssize_t sent =
        ::send(client.socket.get(), client.to_send.data(), client.to_send.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (sent > 0) client.to_send.erase(0, static_cast<std::size_t>(sent));
  }
  return !(client.closing && client.to_send.empty());
}

}  // namespace kaz::sim
