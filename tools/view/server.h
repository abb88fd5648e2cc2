// HTTP and WebSocket on one port: the page, the robot's files, and the channels of a run.
// SPDX-License-Identifier: Apache-2.0
//
// One thread does all input and output. publish() never waits for a viewer: what one does not take is kept up
// to a bound, and then left out for it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "tools/view/protocol.h"

namespace kaz::watch {

struct ServedFile {
  std::string type;  // "text/html"
  Bytes bytes;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;  // 0: any
  std::string name = "kaz";
  // Whoever states it in the address (?token=) may control. Empty: nobody.
  std::string token;
  bool token_to_look = false;               // without it nothing but the page
  std::map<std::string, ServedFile> page;   // by path: "/index.html"
  std::map<std::string, ServedFile> robot;  // "/robot/kaz.urdf"; asset package://robot/kaz.urdf
  std::map<std::string, std::string> parameters;  // that viewers may read
  bool hands = false;                             // viewers may publish on kHandTopic
  std::uint64_t start_ns = 0, end_ns = 0;         // of a recording that is played; 0: there is none
  std::size_t most_connections = 64;
  // What waits at most for one viewer, of channels that are recorded and of the others.
  std::size_t most_waiting = 8 << 20, most_waiting_derived = 512 << 10;
};

class Server {
 public:
  // Errors (environment): the address is none of this machine's, or taken.
  static Result<std::unique_ptr<Server>> open(ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;

  // From any thread. A topic that is there keeps its number. `derived`: not of a recording.
  std::uint32_t add_channel(Channel channel, bool derived = false);
  // Whether somebody has subscribed to it.
  bool wanted(std::uint32_t channel) const;
  // `kept`: whoever subscribes later gets the newest one at once.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data,
               bool kept = false);
  void publish_time(std::uint64_t time_ns);
  void publish_playback(const PlaybackState& state);
  // Called on the server's thread, for viewers with the token; not once this has been called again. It must
  // not call the server.
  void on_playback(std::function<void(const Playback&)> heard);
  // What viewers with the token publish on kHandTopic, called as above; its error goes back to the viewer.
  // ServerOptions::hands.
  void on_hand(std::function<Result<void>(const std::string& line)> heard);
  // A sentence for all viewers.
  void publish_error(const std::string& sentence);

  std::size_t viewers() const;        // open WebSocket connections
  std::size_t subscriptions() const;  // of all
  std::uint64_t left_out() const;     // messages, for viewers that were slow
  std::uint64_t cpu_ns() const;       // of the server's thread
  // Waits until viewers have what was published, or `seconds` are over.
  void drain(double seconds) const;

  struct Impl;

 private:
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// 32 hexadecimal digits.
std::string make_token();

}  // namespace kaz::watch
