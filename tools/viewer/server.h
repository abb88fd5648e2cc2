// HTTP and WebSocket server on one port: serves the page, the robot's files, and the channels of a run.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The threads of a run publish messages. publish() copies a message into a bounded queue and
// returns, without waiting for a viewer or the server. The server's own thread sends the messages to viewers.
// Only the server's thread accesses connections, subscriptions, and the log of the newest messages. Each
// viewer reads the log at the viewer's own pace. A slow viewer misses messages and delays nobody.
//
// Memory. A message is stored once, for any number of viewers. Queue and log are bounded. Each viewer has
// only a small queue of answers to its own requests. If the viewer does not receive these answers, the server
// stops reading the viewer's requests.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "tools/viewer/entry.h"
#include "tools/viewer/protocol.h"

namespace kaz::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;  // TCP port; 0: any free port
  std::string name = "kaz";
  Access access;
  std::map<std::string, std::string> parameters;  // parameters that viewers can read
  bool hands = false;                             // true: viewers may publish on kHandTopic
  // Time range of a played recording; end_ns is 0 for a live run.
  std::uint64_t start_ns = 0, end_ns = 0;
  std::size_t most_connections = 64;
  // Maximum total bytes in the queue between publish() and the server's thread.
  std::size_t most_queued = 4 << 20;
  std::size_t most_logged = 8 << 20;  // maximum total bytes in the log
};

class Server {
 public:
  // Starts the server. Returns Fault::usage if the address is not numeric. Returns Fault::environment if the
  // server cannot listen at the address.
  static Result<std::unique_ptr<Server>> open(ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;

  // Any thread may call the functions below.

  // Adds a channel and returns its number. If the topic exists, returns the number of the existing channel.
  // `derived`: recordings do not contain the channel; a viewer that is more than half a second behind misses
  // messages of the channel.
  std::uint32_t add_channel(Channel channel, bool derived = false);
  // Returns whether a viewer has subscribed to the channel.
  bool wanted(std::uint32_t channel) const;
  struct Publication {
    bool kept = false;      // true: later subscribers get the newest message at once
    bool observed = false;  // true: the message is passed to the handler of on_message()
  };
  // Publishes a message; never waits. Does nothing if the message is neither wanted, kept nor observed. If
  // the queue is full, drops the message.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data,
               Publication how);
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
    publish(channel, time_ns, data, {});
  }
  // Publishes the time of the run. Each viewer gets the newest time after all other messages.
  void publish_time(std::uint64_t time_ns);
  void publish_playback(const PlaybackState& state);
  // Sends an error message to all viewers.
  void publish_error(const std::string& sentence);

  // The next three functions set handlers. The server's thread calls the handlers. After one of these
  // functions has returned, the previous handler is not called any more. Handlers must not call these
  // functions.

  // Sets the handler for requests to control the player of a recording. Only viewers with the token can make
  // such requests.
  void on_playback(std::function<void(const Playback&)> handler);
  // Sets the handler for a line that a viewer with the token publishes on kHandTopic (ServerOptions::hands).
  // If the handler returns an error, the viewer gets this error.
  void on_hand(std::function<Result<void>(const std::string& line)> handler);
  // Sets the handler for observed messages.
  void on_message(std::function<void(std::string_view topic, std::uint64_t time_ns,
                                     std::span<const std::uint8_t> data)>
                      handler);

  std::size_t viewers() const;        // number of open WebSocket connections
  std::size_t subscriptions() const;  // total number of subscriptions of all viewers
  // Returns the number of messages that the queue dropped or slow viewers missed.
  std::uint64_t left_out() const;
  std::uint64_t cpu_ns() const;  // CPU time of the server's thread
  // Waits until all viewers have received everything that was published, for at most `seconds`.
  void drain(double seconds) const;

  struct Impl;

 private:
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Returns a new token: 32 random hexadecimal digits.
std::string make_token();

// Nice value of the threads that work for viewers. With this value, the run has priority over these threads.
inline constexpr int kViewNice = 10;

}  // namespace kaz::viewer
