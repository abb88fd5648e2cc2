// Link over a CAN bus: each frame of the wire protocol is one ISO-TP message.
// SPDX-License-Identifier: Apache-2.0
//
// What stands between two zeros of the line (stuffed body and check, docs/reference/protocol.md) is the
// message; the zeros stay behind, and the receiving end puts them back. So the board's check covers the
// whole path.
//
//   requests to address a   identifier kCanRequests + a, a = 1..14
//   replies from address a  identifier kCanReplies + a; on both, flow control for the other
//   requests to all boards  identifier kCanRequests + 15, without flow control, as its receivers are several
//
// A frame whose address is none of these (damaged, or a test's) goes to all boards, each of which ignores
// it, as on a line. What cannot cross: pauses between bytes, and framing and parity errors; bytes without
// a zero behind them; the bit rate of the line.
//
// The kernel gives a transfer up a second after its receiver has stopped answering; here after kGiveUp,
// so that a board that is gone for a while is not deaf for longer.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "host/link/can_sockets.h"
#include "host/link/port_link.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

inline constexpr std::uint32_t kCanRequests = 0x6A0, kCanReplies = 0x6B0;
inline constexpr std::uint8_t kCanAll = 15;

struct CanStatistics {
  std::uint64_t frames_in = 0, frames_out = 0;  // of the wire protocol
  std::uint64_t error_frames = 0;               // from the controller, of all kinds
  std::uint64_t bus_off = 0, restarts = 0, overflows = 0;
  std::uint64_t unfinished_out = 0;  // nobody, or nobody any more, took the message
  std::uint64_t unfinished_in = 0;   // messages that were broken off, or out of order
  std::uint64_t discarded = 0;  // bytes without a zero, and messages that no receiver waited for
  std::string text() const;     // "3 error frames, bus-off once"; empty if all is well
};

class CanLink final : public PortLink {
 public:
  enum class End {
    host,  // sends requests, to all 14 addresses
    board,  // sends replies of the boards with these addresses, and hears requests to them and to all
  };
  struct Options {
    End end = End::host;
    std::vector<std::uint8_t> addresses = {};  // of End::board: 1..14, at least one
    const Interrupt* interrupt = nullptr;      // may be null; else it must outlive the link
  };
  static constexpr Time kGiveUp = std::chrono::milliseconds(200);

  // Errors: those of CanSockets.
  static Result<std::unique_ptr<CanLink>> open(std::unique_ptr<CanSockets> sockets,
                                               const Options& options);

  std::string name() const override { return "can:" + sockets_->interface(); }
  // Error (environment): a bus has no such lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::bus; }
  int descriptor() const override { return events_.get(); }
  bool has_unsent() const override { return any_waiting() || !received_.empty(); }
  // Fails when the interface is down or gone.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // Fails when the interface is down or gone, and at bus-off; each later call too, until reopen() succeeds.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // Fails with the sentence of CanSockets::check until the interface carries frames again.
  Result<void> reopen() override;

  std::string counts() const override { return statistics_.text(); }
  const CanStatistics& statistics() const { return statistics_; }

 private:
  struct Channel {
    IsoTpChannel ids;
    Descriptor socket;
    std::deque<std::vector<std::uint8_t>> waiting;
    Time since{};  // when the first of them began to wait
    bool used = false;
  };

  CanLink(std::unique_ptr<CanSockets> sockets, const Options& options);
  Result<void> open_all();
  Result<void> open_channel(std::uint8_t number);
  Result<void> watch(int descriptor, std::uint32_t tag);
  std::uint8_t channel_for(std::span<const std::uint8_t> message) const;
  Result<void> send_message();
  Result<void> flush(Channel& channel);
  Result<void> flush_all();
  bool any_waiting() const;
  Result<void> take_ready();
  Result<void> take_messages(Channel& channel);
  Result<void> take_errors();
  void count_error_frame(std::uint32_t classes);
  Error lost();

  std::unique_ptr<CanSockets> sockets_;
  Options options_;
  Descriptor events_;  // epoll of all sockets
  Descriptor errors_;
  std::array<Channel, kCanAll + 1> channels_;  // by address; 15: all
  std::vector<std::uint8_t> message_;          // that is being written: no zero has come yet
  bool too_long_ = false;
  std::deque<std::uint8_t> received_;
  bool bus_off_ = false;
  CanStatistics statistics_;
};

}  // namespace kaz::host
