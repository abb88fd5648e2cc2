// HTTP and WebSocket on one port: the page, the robot's files, and the channels of a run.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The threads of a run publish. publish() copies a message into a bounded queue and returns; it
// waits neither for a viewer nor for the server. The server's own thread does all the rest: it alone has
// the connections, the viewers with their subscriptions, and the log of the newest messages. Every viewer
// reads that log at its own pace. A slow viewer misses messages and delays nobody.
//
// Memory. A message is stored once, whatever the number of viewers. The queue and the log are bounded; a
// viewer has at most some answers to its own requests, and is not read from until it takes them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "tools/view/entry.h"
#include "tools/view/protocol.h"

namespace kaz::watch {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;  // 0: any
  std::string name = "kaz";
  Access access;
  std::map<std::string, std::string> parameters;  // that viewers may read
  bool hands = false;                             // viewers may publish on kHandTopic
  std::uint64_t start_ns = 0, end_ns = 0;         // of a recording that is played; 0: there is none
  std::size_t most_connections = 64;
  std::size_t most_queued = 4 << 20;  // bytes between publish() and the server's thread
  std::size_t most_logged = 8 << 20;  // bytes of the log
};

class Server {
 public:
  // Errors (environment): the address is none of this machine's, or taken.
  static Result<std::unique_ptr<Server>> open(ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;

  // All functions below may be called from any thread.

  // Returns the channel's number; a topic that is there keeps its own. Messages of `derived` channels, which
  // no recording has, are left out for a viewer that is half a second behind.
  std::uint32_t add_channel(Channel channel, bool derived = false);
  // Whether a viewer has subscribed to it.
  bool wanted(std::uint32_t channel) const;
  struct Publication {
    bool kept = false;      // viewers that subscribe later get the newest one at once
    bool observed = false;  // the handler of on_message() gets it
  };
  // Returns at once if the message is neither wanted, kept nor observed. If the queue is full, the message is
  // left out.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data,
               Publication how);
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
    publish(channel, time_ns, data, {});
  }
  // The run's time. A viewer gets the newest one when it has everything else.
  void publish_time(std::uint64_t time_ns);
  void publish_playback(const PlaybackState& state);
  // A sentence for all viewers.
  void publish_error(const std::string& sentence);

  // Handlers. They are called on the server's thread. When one of these functions returns, the handler before
  // is not called any more; a handler must not call them.
  // A viewer with the token controls the player.
  void on_playback(std::function<void(const Playback&)> handler);
  // A viewer with the token published a line on kHandTopic (ServerOptions::hands). An error is sent to it.
  void on_hand(std::function<Result<void>(const std::string& line)> handler);
  // An observed message came.
  void on_message(std::function<void(std::string_view topic, std::uint64_t time_ns,
                                     std::span<const std::uint8_t> data)>
                      handler);

  std::size_t viewers() const;        // open WebSocket connections
  std::size_t subscriptions() const;  // of all viewers
  // Messages that did not fit into the queue, and those that a slow viewer missed, counted for each viewer.
  std::uint64_t left_out() const;
  std::uint64_t cpu_ns() const;  // of the server's thread
  // Waits until viewers have everything that was published, at most `seconds`.
  void drain(double seconds) const;

  struct Impl;

 private:
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// 32 hexadecimal digits.
std::string make_token();

// Priority of threads that work for viewers: they get what the run leaves of the processor.
inline constexpr int kViewNice = 10;

}  // namespace kaz::watch
