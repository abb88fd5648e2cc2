// Requests and replies, counted against each other.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/conversation.h"

#include "shared/protocol/bytes.h"
#include "shared/protocol/message_info.h"

namespace kaz::hil::fuzz {
namespace {

std::string name_of(std::uint8_t type) {
  const kz_message_info* message = kz_message_find(type);
  if (message != nullptr) return message->name;
  return std::string("type ").append(std::to_string(type));
}

std::uint32_t key(std::uint8_t address, std::uint8_t type, std::uint8_t sequence) {
  return static_cast<std::uint32_t>(address) << 16 | static_cast<std::uint32_t>(type) << 8 |
         sequence;
}

}  // namespace

Conversation::Conversation(std::uint8_t address) : address_(address) {
  kz_receiver_init(&to_board_);
  kz_receiver_init(&to_host_);
}

void Conversation::wrong(const std::string& what) {
  if (!violation_) violation_ = what;
}

void Conversation::sent(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (kz_receive(&to_board_, byte, 0) == KZ_RECEIVE_FRAME)
      request({to_board_.body, to_board_.length});
  }
}

void Conversation::request(std::span<const std::uint8_t> body) {
  ++counts_.requests;
  const std::uint8_t address = body[0], type = body[1];
  if (kz_interrupts_service(type)) {
    deafening_ = true;
    ++restarts_;
  }
  if (type == KZ_TYPE_telemetry) telemetry_ = true;
  if (type == KZ_TYPE_set_address) address_known_ = false;
  if (type == KZ_TYPE_enable || type == KZ_TYPE_raw_drive) switched_on_ = counts_.requests;
  if (address == KZ_ADDRESS_ALL || (type & KZ_REPLY) != 0) return;
  Transmission transmission{counts_.requests, 0};
  if (type == KZ_TYPE_enable && body.size() == KZ_HEADER_SIZE + KZ_SIZE_enable)
    transmission.mask = kz_get_u32(&body[KZ_HEADER_SIZE]);
  SentRequest& request_sent = sent_[key(address, type, body[2])];
  request_sent.unanswered.push_back(transmission);
  request_sent.answered = 0;
}

bool Conversation::take_deafening() {
  const bool was = deafening_;
  deafening_ = false;
  return was;
}

int Conversation::replies_to(std::uint8_t type, std::uint8_t sequence) const {
  const auto request_sent = sent_.find(key(address_, type, sequence));
  return request_sent == sent_.end() ? 0 : request_sent->second.answered;
}

void Conversation::received(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    const u8 what = kz_receive(&to_host_, byte, 0);
    if (what == KZ_RECEIVE_MORE) continue;
    if (what == KZ_RECEIVE_FRAME) {
      frame({to_host_.body, to_host_.length});
      continue;
    }
    ++counts_.damaged;
    // One frame can be cut off by each restart.
    if (!faulty_ && restarts_-- <= 0) wrong("the board sent a damaged frame");
  }
}

void Conversation::frame(std::span<const std::uint8_t> body) {
  const std::uint8_t address = body[0], type = body[1], sequence = body[2];
  if (address != address_ && address_known_ && !faulty_)
    return wrong("a frame came from address " + std::to_string(address) +
                 ", which is not the board's");
  const kz_message_info* message = kz_message_find(type);
  if (message == nullptr || (type & KZ_REPLY) == 0)
    return wrong("the board sent a frame of " + name_of(type) + ", which is not a reply");
  if (body.size() < KZ_HEADER_SIZE + 6)
    return wrong("a frame of " + name_of(type) + " has no tick and status");
  const auto status = static_cast<std::uint16_t>(body[7] << 8 | body[8]);
  if (type == KZ_TYPE_identify_reply) {
    judge_status(type, static_cast<std::uint16_t>(body[9] << 8 | body[10]));
  } else {
    judge_status(type, status);
    judge_switched_off(body, status);
  }
  if ((type & 0xC0) == 0xC0 && type != KZ_TYPE_refused) {
    ++counts_.telemetry;
    features_.insert(0x01000000u | type);
    if (!telemetry_ && !faulty_) wrong(name_of(type) + " came without a subscription to telemetry");
    return;
  }
  if (type == KZ_TYPE_refused) {
    ++counts_.refusals;
    if (body.size() != KZ_HEADER_SIZE + KZ_SIZE_refused)
      return wrong("a refusal has a wrong length");
    features_.insert(0x02000000u | static_cast<std::uint32_t>(body[9]) << 8 | body[10]);
    return reply(address, body[9], sequence, "a refusal of " + name_of(body[9]));
  }
  ++counts_.replies;
  features_.insert(0x03000000u | static_cast<std::uint32_t>(type) << 16 | status);
  reply(address, static_cast<std::uint8_t>(type & ~KZ_REPLY), sequence, name_of(type));
}

void Conversation::reply(std::uint8_t address, std::uint8_t request, std::uint8_t sequence,
                         const std::string& what) {
  const auto request_sent = sent_.find(key(address, request, sequence));
  const std::string number = " with number " + std::to_string(sequence);
  if (request_sent == sent_.end() || request_sent->second.unanswered.empty()) {
    if (!faulty_)
      wrong(what + number +
            (request_sent == sent_.end() ? " answers no request"
                                         : " came more often than it was requested"));
    return;
  }
  request_sent->second.unanswered.pop_front();
  ++request_sent->second.answered;
}

// After a latched shutdown no motor is on, except while the watchdog holds the joints.
void Conversation::judge_status(std::uint8_t type, std::uint16_t status) {
  const bool holding = (status & KZ_STATUS_HOLDING) != 0;
  const bool on = (status & (KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE)) != 0;
  if ((status >> 8) != KZ_SHUTDOWN_NONE && on && !holding)
    wrong(name_of(type) + " reports that motors are on despite the shutdown \"" +
          kz_shutdown_text(static_cast<u8>(status >> 8)) + "\"");
  if (holding && (status >> 8) != KZ_SHUTDOWN_LINK_LOST)
    wrong(name_of(type) + " has HOLDING set, but the shutdown reason is not LINK_LOST");
}

// A reply must show as off what its request switches off, unless a later request may have switched it on.
void Conversation::judge_switched_off(std::span<const std::uint8_t> body, std::uint16_t status) {
  const std::uint8_t type = body[1];
  if (type != KZ_TYPE_stop_reply && type != KZ_TYPE_enable_reply) return;
  const auto sent = sent_.find(key(body[0], static_cast<std::uint8_t>(type & ~KZ_REPLY), body[2]));
  if (sent == sent_.end() || sent->second.unanswered.empty()) return;
  const Transmission& oldest = sent->second.unanswered.front();
  if (oldest.number < switched_on_) return;
  if (type == KZ_TYPE_stop_reply && (status & (KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE)) != 0)
    wrong("the reply to `stop` reports that motors are on");
  if (type == KZ_TYPE_enable_reply && body.size() == KZ_HEADER_SIZE + KZ_SIZE_enable_reply &&
      (kz_get_u32(&body[KZ_HEADER_SIZE + 6]) & ~oldest.mask) != 0)
    wrong("the reply to `enable` reports that joints outside the mask are on");
}

}  // namespace kaz::hil::fuzz
