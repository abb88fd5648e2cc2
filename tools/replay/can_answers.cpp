// Repeats the requests of a CAN log, and compares the answers field by field.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/can_answers.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "host/link/can_link.h"
#include "host/link/frame_log.h"
#include "shared/protocol/message_info.h"

namespace kaz::tools {
namespace {

using Body = std::vector<std::uint8_t>;

constexpr Time kLastAnswers = std::chrono::milliseconds(200);
// Answers among which the partner of an answer is searched. A host has few requests under way.
constexpr std::ptrdiff_t kMostSkipped = 16;
constexpr std::array<std::string_view, 14> kMeasured = {
    "angle",          "speed",        "duty",     "load",    "supply_mv", "supply_lowest_mv",
    "temperature_dc", "reference",    "yaw_rate", "forward", "left",      "busy_8states",
    "worst_8states",  "start_8states"};

// Decodes frames from bytes of a line, and hands their bodies on.
class FrameDecoder {
 public:
  FrameDecoder() { kz_receiver_init(&receiver_); }
  std::optional<Body> take(std::uint8_t byte) {
    if (kz_receive(&receiver_, byte, 0) != KZ_RECEIVE_FRAME) return std::nullopt;
    return Body(receiver_.body, receiver_.body + receiver_.length);
  }

 private:
  kz_receiver receiver_{};
};

bool is_telemetry(const CanAnswer& answer) {
  return kz_kind_of(answer.body[KZ_BODY_TYPE]) == KZ_KIND_TELEMETRY;
}

bool is_tick(std::string_view field) {
  return field == "tick" || field == "shutdown_tick";
}

// Counters since the start of the board depend on the time before the log, too.
bool is_measured(std::uint8_t type, std::string_view field) {
  return std::ranges::find(kMeasured, field) != kMeasured.end() ||
         (type == KZ_TYPE_statistics_reply && field != "status");
}

// Flags whose time depends on the speed of a joint.
std::int64_t judged_bits(std::string_view field, std::int64_t value) {
  if (field == "status") return value & ~std::int64_t{KZ_STATUS_MOVING};
  return field == "faults" ? value & ~std::int64_t{KZ_JOINT_MOVING} : value;
}

std::string title(const CanAnswer& answer) {
  return std::string(host::message_name(answer.body[KZ_BODY_TYPE])) + " #" +
         std::to_string(answer.body[KZ_BODY_SEQUENCE]);
}

struct FieldValues {
  const kz_field_info* field = nullptr;
  std::vector<std::int64_t> values;
};

// Returns the fields of a body; nullopt if the body does not fit the message table.
std::optional<std::vector<FieldValues>> fields_of(const Body& body) {
  const kz_message_info* message = kz_message_find(body[KZ_BODY_TYPE]);
  if (!message) return std::nullopt;
  std::vector<FieldValues> fields;
  std::size_t at = KZ_HEADER_SIZE;
  std::int64_t mask = 0;
  for (std::size_t f = 0; f < message->field_count; ++f) {
    const kz_field_info& field = message->fields[f];
    FieldValues& added = fields.emplace_back(FieldValues{&field, {}});
    int left = field.count;
    for (int joint = 0; left > 0 && (!field.mask || joint < KZ_JOINTS); ++joint) {
      if (field.mask && !(mask >> joint & 1)) continue;
      if (at + field.size > body.size()) return std::nullopt;
      std::int64_t value = 0;
      for (int k = 0; k < field.size; ++k) value = value << 8 | body[at++];
      if (field.type == std::string_view("s16")) value = static_cast<std::int16_t>(value);
      added.values.push_back(value);
      --left;
    }
    if (field.name == std::string_view("mask") && !added.values.empty()) mask = added.values[0];
  }
  if (at != body.size()) return std::nullopt;
  return fields;
}

class Comparer {
 public:
  // Answers of one board.
  void board(const std::vector<const CanAnswer*>& recorded,
             const std::vector<const CanAnswer*>& now) {
    auto next = now.begin();
    for (const CanAnswer* answer : recorded) {
      const auto end = next + std::min(kMostSkipped, now.end() - next);
      const auto found = std::find_if(next, end, [&](const CanAnswer* other) {
        return other->body[KZ_BODY_SEQUENCE] == answer->body[KZ_BODY_SEQUENCE];
      });
      if (found == end) {
        add("missing", answer, nullptr, title(*answer) + ": no answer now");
        continue;
      }
      for (; next != found; ++next) unexpected(**next);
      compare(*answer, **next++);
    }
    for (; next != now.end(); ++next) unexpected(**next);
  }
  CanComparison take() { return std::move(result_); }
  void skip_telemetry() { ++result_.telemetry; }

 private:
  void unexpected(const CanAnswer& answer) {
    add("unexpected", nullptr, &answer, title(answer) + ": no such answer in the log");
  }

  void add(const std::string& group, const CanAnswer* recorded, const CanAnswer* now,
           const std::string& what) {
    const CanAnswer& one = recorded ? *recorded : *now;
    const std::string key = std::to_string(one.id) + " " + group;
    const auto [found, is_new] = groups_.try_emplace(key, result_.differences.size());
    if (!is_new) {
      ++result_.differences[found->second].count;
      return;
    }
    result_.differences.push_back({one.line, one.time, one.id, what,
                                   recorded ? recorded->body : Body(), now ? now->body : Body()});
  }

  void compare(const CanAnswer& recorded, const CanAnswer& now) {
    ++result_.answers;
    const std::uint8_t type = recorded.body[KZ_BODY_TYPE];
    if (now.body[KZ_BODY_TYPE] != type) {
      add("type", &recorded, &now,
          title(recorded) + ": the answer now is " + title(now) + " " +
              host::describe_fields(now.body));
      return;
    }
    const auto a = fields_of(recorded.body), b = fields_of(now.body);
    if (!a || !b) {  // not in the message table: compared as bytes
      if (recorded.body != now.body)
        add("bytes", &recorded, &now, title(recorded) + ": the bytes differ");
      return;
    }
    for (std::size_t f = 0; f < a->size(); ++f) compare_field(recorded, now, (*a)[f], (*b)[f]);
  }

  void compare_field(const CanAnswer& recorded, const CanAnswer& now, const FieldValues& a,
                     const FieldValues& b) {
    const std::string name = a.field->name;
    if (is_tick(name)) return;
    const bool measured = is_measured(recorded.body[KZ_BODY_TYPE], name);
    for (std::size_t k = 0; k < a.values.size() && k < b.values.size(); ++k) {
      const std::int64_t then = judged_bits(name, a.values[k]),
                         here = judged_bits(name, b.values[k]);
      if (measured) {
        MeasuredDifference& largest = result_.measured[name];
        largest.largest = std::max(largest.largest, std::abs(then - here));
        largest.unit = a.field->unit;
      } else if (then != here) {
        const std::string at = a.field->count > 1 ? "[" + std::to_string(k) + "]" : "";
        add(title(recorded).substr(0, title(recorded).find(' ')) + " " + name, &recorded, &now,
            title(recorded) + ": " + name + at + " is " + std::to_string(then) + " in the log, " +
                std::to_string(here) + " now");
        return;
      }
    }
  }

  CanComparison result_;
  std::map<std::string, std::size_t> groups_;  // index of each difference
};

using ByBoard = std::map<std::uint32_t, std::vector<const CanAnswer*>>;

ByBoard by_board(const std::vector<CanAnswer>& answers) {
  ByBoard boards;
  for (const CanAnswer& answer : answers) {
    if (!is_telemetry(answer)) boards[answer.id].push_back(&answer);
  }
  return boards;
}

}  // namespace

std::vector<CanAnswer> answers_in(const CanMessages& log) {
  std::vector<CanAnswer> answers;
  for (const CanMessage& message : log.messages) {
    if (message.from_host) continue;
    FrameDecoder decoder;
    decoder.take(0);
    for (const std::uint8_t byte : message.bytes) decoder.take(byte);
    if (auto body = decoder.take(0))
      answers.push_back({message.line, message.time, message.id, std::move(*body)});
  }
  return answers;
}

Result<std::vector<CanAnswer>> repeat_requests(const CanMessages& log, host::Link& link,
                                               host::Clock& clock, Time lead) {
  std::vector<CanAnswer> answers;
  FrameDecoder decoder;
  const Time start = clock.now() + lead;
  const auto read_until = [&](Time deadline) -> Result<void> {
    std::array<std::uint8_t, 256> bytes;
    while (true) {
      const std::size_t count = KAZ_TRY(link.read(bytes, deadline));
      const Time now = clock.now();
      for (std::size_t k = 0; k < count; ++k) {
        auto body = decoder.take(bytes[k]);
        // A line may return an echo of the requests.
        if (!body || !((*body)[KZ_BODY_TYPE] & KZ_REPLY)) continue;
        answers.push_back({0, now - start, host::kCanReplies + (*body)[KZ_BODY_ADDRESS], *body});
      }
      if (count == 0 || now >= deadline) return {};
    }
  };
  for (const CanMessage& message : log.messages) {
    if (!message.from_host) continue;
    KAZ_TRY(read_until(start + message.time));
    Body wire = {0};
    wire.insert(wire.end(), message.bytes.begin(), message.bytes.end());
    wire.push_back(0);
    KAZ_TRY(link.write(wire));
  }
  KAZ_TRY(read_until(start + log.messages.back().time + kLastAnswers));
  return answers;
}

CanComparison compare_answers(const std::vector<CanAnswer>& recorded,
                              const std::vector<CanAnswer>& now) {
  Comparer comparer;
  for (const CanAnswer& answer : recorded) {
    if (is_telemetry(answer)) comparer.skip_telemetry();
  }
  ByBoard boards = by_board(recorded), others = by_board(now);
  for (const auto& [id, answers] : others) boards[id];
  for (const auto& [id, answers] : boards) comparer.board(answers, others[id]);
  return comparer.take();
}

}  // namespace kaz::tools
