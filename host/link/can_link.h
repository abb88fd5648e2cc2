// Link over a CAN bus: each frame of the wire protocol is one ISO-TP message.
// SPDX-License-Identifier: Apache-2.0
//
// A message contains the bytes that are between two zero bytes on a serial line: the stuffed body and the
// checksum (docs/reference/protocol.md). The zero bytes are not transmitted; the receiver adds the zero bytes
// again. The checksum of the protocol is transmitted unchanged, so the checksum covers the whole path from
// the sender to the receiver.
//
//   identifier             carries
//   kCanRequests + 1..14   requests to this address
//   kCanReplies + 1..14    replies from this address
//   kCanRequests + 15      requests to all boards
//
// Each address has two identifiers, one for requests and one for replies. The receiver of a request sends
// ISO-TP flow control with the identifier for replies. The receiver of a reply sends ISO-TP flow control with
// the identifier for requests. A broadcast has no flow control, because a broadcast has several receivers.
//
// A frame with any other address (a damaged frame, or a frame from a test) is sent to all boards. As on a
// serial line, all boards ignore such a frame. A CAN link cannot transfer pauses between bytes, framing and
// parity errors, the bit rate, or bytes that are not followed by a zero byte.
//
// If a receiver stops answering, CanLink aborts the transfer after 200 ms (kGiveUp). The kernel also aborts
// such a transfer, but only after one second.
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
  std::uint64_t frames_in = 0, frames_out = 0;  // number of frames of the wire protocol
  // Number of error frames of all kinds from the controller.
  std::uint64_t error_frames = 0;
  std::uint64_t bus_off = 0, restarts = 0, overflows = 0;
  std::uint64_t unfinished_out = 0;  // sent messages that no receiver accepted completely
  std::uint64_t unfinished_in = 0;   // received messages that were broken off or out of order
  // Number of discarded frames: frames longer than 4095 bytes, and frames for a receiver whose queue was
  // full.
  std::uint64_t discarded = 0;
  // Returns a text such as "3 error frames, bus-off once"; empty if all counts except frames_in and
  // frames_out are 0.
  std::string text() const;
};

class CanLink final : public PortLink {
 public:
  enum class End {
    host,  // sends requests to all 14 addresses
    // Acts as the boards with the addresses in Options::addresses. This end sends the replies of these
    // boards. This end receives broadcasts, and requests to these boards.
    board,
  };
  struct Options {
    End end = End::host;
    std::vector<std::uint8_t> addresses = {};  // for End::board: one or more addresses, 1..14
    const Interrupt* interrupt = nullptr;      // may be null; else it must outlive the link
  };
  // Time after which a message is dropped if no receiver accepts the message.
  static constexpr Time kGiveUp = std::chrono::milliseconds(200);

  // Returns the errors of CanSockets.
  static Result<std::unique_ptr<CanLink>> open(std::unique_ptr<CanSockets> sockets,
                                               const Options& options);

  std::string name() const override { return "can:" + sockets_->interface(); }
  // Always fails (environment): a bus has no modem lines.
  Result<void> set_dtr_rts(bool dtr, bool rts) override;
  LowLatency low_latency() const override { return LowLatency::bus; }
  int descriptor() const override { return events_.get(); }
  bool has_unsent() const override { return any_waiting() || !received_.empty(); }
  // Queues the complete frames in `bytes` and sends as many frames as the bus accepts. Fails if the interface
  // is down or gone.
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  // Fails if the interface is down, gone or bus-off. After such a failure, every call fails until reopen()
  // succeeds.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // Opens all sockets again. As long as the interface carries no frames, fails with the error of
  // CanSockets::check.
  Result<void> reopen() override;

  std::string counts() const override { return statistics_.text(); }
  const CanStatistics& statistics() const { return statistics_; }

 private:
  struct Channel {
    IsoTpChannel ids;
    Descriptor socket;
    std::deque<std::vector<std::uint8_t>> waiting;
    Time since{};  // time at which the first waiting message was queued
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
  Descriptor events_;  // epoll descriptor that watches all sockets
  Descriptor errors_;
  std::array<Channel, kCanAll + 1> channels_;  // indexed by address; 15: broadcasts
  // Message that is being written, not yet ended by a zero byte.
  std::vector<std::uint8_t> message_;
  bool too_long_ = false;
  std::deque<std::uint8_t> received_;
  bool bus_off_ = false;
  CanStatistics statistics_;
};

}  // namespace kaz::host
