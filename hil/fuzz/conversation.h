// Judges the traffic on the line: each reply belongs to one request, and no reply comes twice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"

namespace kaz::hil::fuzz {

struct ConversationCounts {
  long long requests = 0, replies = 0, refusals = 0, telemetry = 0, damaged = 0;
};

class Conversation {
 public:
  // `address` is the address of the board.
  explicit Conversation(std::uint8_t address = KZ_ADDRESS_DEFAULT);

  // Must be called with all bytes that the host has sent or received, in the order of the transmissions.
  void sent(std::span<const std::uint8_t> bytes);
  void received(std::span<const std::uint8_t> bytes);

  // Must be called before bytes are lost, changed or duplicated on the line. After this call, the bytes that
  // reach the board are uncertain. So Conversation checks only the rules for single frames.
  void line_is_faulty() { faulty_ = true; }
  // Must be called when the board may have restarted. A restart can cut off the frame that the board is
  // sending. Therefore one damaged frame is allowed for each call.
  void board_restarted() { restarts_ += 1; }

  // Returns how many replies have come since the newest transmission of a request. `type` and `sequence`
  // identify the request.
  int replies_to(std::uint8_t type, std::uint8_t sequence) const;
  // Some requests can make the board silent for a while: a restart, a write to flash, and a change of the
  // address. Returns whether the host has sent such a request since the last call of take_deafening().
  bool take_deafening();

  // Returns the first violation; nullopt if there was no violation.
  const std::optional<std::string>& violation() const { return violation_; }
  const ConversationCounts& counts() const { return counts_; }
  // Returns the set of all kinds of replies that have been received. A kind is a code that combines the type,
  // the reason and the status of a reply.
  const std::set<std::uint32_t>& features() const { return features_; }

 private:
  struct Transmission {
    // 1 for the first request that the host sent, 2 for the second. Requests to other boards also count.
    long long number = 0;
    std::uint32_t mask = 0;  // joint mask of `enable`
  };
  struct SentRequest {
    std::deque<Transmission> unanswered;
    int answered = 0;  // number of answers since the request was last sent
  };

  void request(std::span<const std::uint8_t> body);
  void frame(std::span<const std::uint8_t> body);
  void reply(std::uint8_t address, std::uint8_t request, std::uint8_t sequence,
             const std::string& what);
  void judge_status(std::uint8_t type, std::uint16_t status);
  void judge_switched_off(std::span<const std::uint8_t> body, std::uint16_t status);
  void wrong(const std::string& what);

  std::uint8_t address_;
  kz_receiver to_board_{}, to_host_{};
  std::map<std::uint32_t, SentRequest> sent_;  // key: address, type, sequence number
  // Transmission::number of the newest request that can switch a motor on.
  long long switched_on_ = 0;
  bool telemetry_ = false, address_known_ = true, faulty_ = false, deafening_ = false;
  int restarts_ = 0;
  ConversationCounts counts_;
  std::set<std::uint32_t> features_;
  std::optional<std::string> violation_;
};

}  // namespace kaz::hil::fuzz
