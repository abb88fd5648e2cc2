// State that the connections of a server share. Only for server.cpp and viewer.cpp.
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
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "tools/view/inbox.h"
#include "tools/view/server.h"

namespace kaz::watch {

class Viewer;

inline constexpr std::size_t kMostChannels = 256;

// A list of channels that only grows. Thread-safe; reading takes no lock.
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

// Counts a connection during its lifetime. Only for the server's thread.
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
  // Moves messages from the inbox to the viewers, now or every few milliseconds.
  void take();
  void take_regularly();

  // Accessed by all threads.
  const ServerOptions options;
  const std::string session;
  Inbox inbox;
  Channels channels;
  std::array<std::atomic<int>, kMostChannels> wanted{};  // subscriptions by channel
  std::atomic<std::size_t> viewer_count{0}, subscription_count{0};
  std::atomic<std::uint64_t> left_out{0};
  std::atomic<std::uint64_t> time_ns{kNoTime};
  static constexpr std::uint64_t kNoTime = ~std::uint64_t{0};
  std::mutex handlers;  // guards the next three; held while one is called
  std::function<void(const Playback&)> on_playback;
  std::function<Result<void>(const std::string&)> on_hand;
  std::function<void(std::string_view, std::uint64_t, std::span<const std::uint8_t>)> on_message;

  // Only accessed by the server's thread.
  struct Logged {
    SharedMessage message;
    std::uint64_t number = 0;  // index among all messages taken
    Clock::time_point at;
  };
  struct Kept {
    SharedMessage message;
    std::uint64_t number = 0;
  };
  // Positions in the log are log_begin, log_begin + 1, ...
  std::deque<Logged> log;
  std::uint64_t log_begin = 0, taken = 0;
  std::size_t log_bytes = 0;
  std::array<Kept, kMostChannels> newest;  // by channel
  SharedMessage newest_for_everyone;       // the player's state
  std::set<Viewer*> viewers;
  std::size_t connections = 0;

  // Its handlers own viewers, which refer to the members above. So it must be destroyed first.
  boost::asio::io_context io{1};
  boost::asio::ip::tcp::acceptor acceptor{io};
  boost::asio::steady_timer next_accept{io};  // retry after a failure to accept
  boost::asio::steady_timer next_take{io};
  std::thread thread;

 private:
  void add_to_log(SharedMessage message, std::uint64_t number);
};

}  // namespace kaz::watch
