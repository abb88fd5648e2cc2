// State that all connections of a server share. Only server, viewer and outbox may include this file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "tools/viewer/inbox.h"
#include "tools/viewer/server.h"

namespace kaz::viewer {

class Viewer;

inline constexpr std::size_t kMostChannels = 256;

// A list of channels; channels are never removed. Thread-safe; reading takes no lock.
class Channels {
 public:
  struct Offered {
    Channel channel;
    bool derived = false;
  };

  std::uint32_t add(Channel channel, bool derived);
  std::size_t size() const { return size_.load(std::memory_order_acquire); }
  const Offered& operator[](std::size_t number) const { return *all_[number]; }

 private:
  std::mutex adding_;
  std::array<std::unique_ptr<const Offered>, kMostChannels> all_;
  std::atomic<std::size_t> size_{0};
};

// Increments a count of connections during the lifetime of this object. Use this class on the server's thread
// only.
class Counted {
 public:
  explicit Counted(std::size_t& count) : count_(count) { ++count_; }
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::size_t& count_;
};

struct Server::Impl {
  using Clock = std::chrono::steady_clock;

  explicit Impl(ServerOptions given)
      : options(std::move(given)), session(make_token()), inbox(options.most_queued) {}

  void accept();
  // take() moves messages from the inbox to the log and the viewers. take_regularly() does this every few
  // milliseconds.
  void take();
  void take_regularly();

  // All threads access the members below.
  const ServerOptions options;
  const std::string session;
  Inbox inbox;
  Channels channels;
  std::array<std::atomic<int>, kMostChannels> wanted{};  // number of subscriptions of each channel
  std::atomic<std::size_t> viewer_count{0}, subscription_count{0};
  std::atomic<std::uint64_t> left_out{0};
  std::atomic<std::uint64_t> time_ns{kNoTime};
  static constexpr std::uint64_t kNoTime = ~std::uint64_t{0};
  std::mutex handlers;  // guards the three handlers below; held during the call of a handler
  std::function<void(const Playback&)> on_playback;
  std::function<Result<void>(const std::string&)> on_hand;
  std::function<void(std::string_view, std::uint64_t, std::span<const std::uint8_t>)> on_message;

  // Only the server's thread accesses the members below.
  struct Logged {
    SharedMessage message;
    std::uint64_t number = 0;  // index of the message among all messages taken from the inbox
    Clock::time_point at;
  };
  struct Kept {
    SharedMessage message;
    std::uint64_t number = 0;
  };
  // The positions of the messages in the log are log_begin, log_begin + 1, ...
  std::deque<Logged> log;
  std::uint64_t log_begin = 0, taken = 0;
  std::size_t log_bytes = 0;
  std::array<Kept, kMostChannels> newest;  // newest message of each channel
  SharedMessage newest_for_everyone;       // message with the newest state of the player
  std::set<Viewer*> viewers;
  std::size_t connections = 0;

  // The handlers of `io` own viewers, and viewers refer to the members above. Therefore `io` must be
  // destroyed first.
  boost::asio::io_context io{1};
  boost::asio::ip::tcp::acceptor acceptor{io};
  // Timer for the next attempt after a connection could not be accepted.
  boost::asio::steady_timer next_accept{io};
  boost::asio::steady_timer next_take{io};
  std::thread thread;

 private:
  void add_to_log(SharedMessage message, std::uint64_t number);
};

}  // namespace kaz::viewer
