// HTTP and WebSocket server on one port: serves the page, the robot's files, and the channels of a run.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The threads of a run publish. publish() copies a message into a bounded queue and returns, without
// waiting for a viewer or the server. The server's own thread does the rest. Only it accesses connections,
// subscriptions, and the log of the newest messages. Each viewer reads that log at its own pace. A slow
// viewer misses messages and delays nobody.
//
// Memory. A message is stored once, for any number of viewers. Queue and log are bounded. A viewer only has a
// few pending answers to its own requests; the server reads no more requests until it takes them.
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
  std::map<std::string, std::string> parameters;  // readable by viewers
  bool hands = false;                             // viewers may publish on kHandTopic
  std::uint64_t start_ns = 0, end_ns = 0;         // range of a played recording; end 0: a live run
  std::size_t most_connections = 64;
  std::size_t most_queued = 4 << 20;  // bytes between publish() and the server's thread
  std::size_t most_logged = 8 << 20;  // bytes in the log
};

class Server {
 public:
  // Returns Fault::usage if the address is not numeric, Fault::environment if it cannot be bound.
  static Result<std::unique_ptr<Server>> open(ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;

  // All functions below may be called on any thread.

  // Adds a channel and returns its number. An existing topic keeps its number. `derived`: not in recordings;
  // a viewer more than half a second behind misses its messages.
  std::uint32_t add_channel(Channel channel, bool derived = false);
  // Returns whether a viewer has subscribed to the channel.
  bool wanted(std::uint32_t channel) const;
  struct Publication {
    bool kept = false;      // later subscribers get the newest one at once
    bool observed = false;  // passed to the handler of on_message()
  };
  // Publishes a message; never waits. Does nothing if it is neither wanted, kept nor observed. If the queue
  // is full, drops the message.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data,
               Publication how);
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
    publish(channel, time_ns, data, {});
  }
  // Publishes the run's time. A viewer gets the newest one after everything else.
  void publish_time(std::uint64_t time_ns);
  void publish_playback(const PlaybackState& state);
  // Sends an error message to all viewers.
  void publish_error(const std::string& sentence);

  // The next three functions set handlers, which run on the server's thread. After they return, the previous
  // handler is not called any more. Handlers must not call them.

  // Called when a viewer with the token controls the player.
  void on_playback(std::function<void(const Playback&)> handler);
  // Called when a viewer with the token publishes a line on kHandTopic (ServerOptions::hands). The viewer
  // gets the returned error.
  void on_hand(std::function<Result<void>(const std::string& line)> handler);
  // Called for each observed message.
  void on_message(std::function<void(std::string_view topic, std::uint64_t time_ns,
                                     std::span<const std::uint8_t> data)>
                      handler);

  std::size_t viewers() const;        // open WebSocket connections
  std::size_t subscriptions() const;  // total over all viewers
  // Returns the number of messages that the queue dropped, plus those that slow viewers missed.
  std::uint64_t left_out() const;
  std::uint64_t cpu_ns() const;  // CPU time of the server's thread
  // Waits until viewers have everything that was published, at most `seconds`.
  void drain(double seconds) const;

  struct Impl;

 private:
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Returns 32 random hexadecimal digits.
std::string make_token();

// Nice value of threads that work for viewers, so that the run has priority.
inline constexpr int kViewNice = 10;

}  // namespace kaz::watch
