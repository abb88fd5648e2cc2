// Judge of what passes over the line: each reply belongs to one request, none comes twice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
  // `address`: of the board.
  explicit Conversation(std::uint8_t address = KZ_ADDRESS_DEFAULT);

  void sent(std::span<const std::uint8_t> bytes);
  void received(std::span<const std::uint8_t> bytes);

  // From now on bytes may be lost, changed or doubled on the line: what the board has seen is not
  // known
  // any more, so only what is true of every frame is judged.
  void line_is_faulty() { faulty_ = true; }
  // The board may have started again: what it was sending may be cut off.
  void board_restarted() { restarts_ += 1; }

  // Replies that have come to the request with this type and number since it was last sent.
  int replies_to(std::uint8_t type, std::uint8_t sequence) const;
  // A request for which the board may be deaf for a while, or change its address, was sent since
  // the
  // last call.
  bool take_deafening();

  const std::optional<std::string>& violation() const { return violation_; }
  const ConversationCounts& counts() const { return counts_; }
  // What kinds of replies there were: type, reason, status.
  const std::set<std::uint32_t>& features() const { return features_; }

 private:
  struct Transmission {
    long long number = 0;    // of the requests of this conversation, to whichever board
    std::uint32_t mask = 0;  // of `enable`
  };
  struct SentRequest {
    std::deque<Transmission> unanswered;
    int answered = 0;  // since it was last sent
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
  std::map<std::uint32_t, SentRequest> sent_;  // by address, type, number
  long long switched_on_ = 0;                  // the last request that can switch a motor on
  bool telemetry_ = false, address_known_ = true, faulty_ = false, deafening_ = false;
  int restarts_ = 0;
  ConversationCounts counts_;
  std::set<std::uint32_t> features_;
  std::optional<std::string> violation_;
};

}  // namespace kaz::hil::fuzz
