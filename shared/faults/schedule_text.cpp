// Schedules of faults as text.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <iterator>

#include "shared/base/files.hpp"
#include "shared/base/number_text.hpp"
#include "shared/board/board.h"
#include "shared/faults/faults.h"

namespace kaz::faults {
namespace {

constexpr std::string_view kJointNames[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) #name,
#include "shared/board/joints.def"
#undef KZ_JOINT
};

std::string quoted(std::string_view word) {
  if (word.empty()) return "the end of the line";
  return std::string("`").append(word).append("`");
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  // The next word; empty at the end.
  std::string_view peek() const {
    const auto begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return rest_.substr(begin, rest_.find_first_of(" \t\r", begin) - begin);
  }
  std::string_view take() {
    const std::string_view word = peek();
    if (!word.empty()) {
      rest_ = rest_.substr(static_cast<std::size_t>(word.data() - rest_.data()) + word.size());
    }
    return word;
  }
  bool take_if(std::string_view word) {
    if (peek() != word) return false;
    take();
    return true;
  }

 private:
  std::string_view rest_;
};

tl::unexpected<Error> expected(const std::string& what, std::string_view instead) {
  return fail(kaz::Fault::usage, "expected " + what + ", found " + quoted(instead));
}

// Unit in which a value was typed, in units of the kind: a time in s may be typed in ms.
double unit_taken(Words& words, const Kind& kind) {
  if (kind.unit == "s" && words.take_if("ms")) return 1e-3;
  if (!kind.unit.empty()) words.take_if(kind.unit);
  return 1;
}

// "1.25 s", "200 ms".
Result<Time> time(Words& words, const std::string& after) {
  const std::string_view digits = words.take();
  const auto value = parse_number<double>(digits);
  if (!value || *value < 0 || *value > 1e6)
    return expected("a time such as `1.25 s` or `200 ms` after `" + after + "`", digits);
  const std::string_view unit = words.take();
  if (unit != "s" && unit != "ms")
    return expected("`s` or `ms` after `" + after + " " + std::string(digits) + "`", unit);
  return Time(std::llround(*value * (unit == "s" ? 1e9 : 1e6)));
}

Result<const Kind*> kind(Words& words) {
  const std::string_view word = words.take();
  std::string names;
  for (const Kind& entry : kinds()) {
    if (entry.name == word) return &entry;
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  return expected("the name of a fault (" + names + ")", word);
}

Result<int> joint(Words& words, const Kind& kind) {
  if (!words.take_if("joint"))
    return expected("`joint` and its number or name after `" + std::string(kind.name) + "`",
                    words.peek());
  const std::string_view word = words.take();
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (word == kJointNames[j] || word == std::to_string(j)) return j;
  }
  return expected("a joint, 0 to 17 or a name such as `neck_pan`", word);
}

// Whether one was there.
Result<bool> way(Words& words, Fault& fault) {
  if (!words.take_if("to")) return false;
  if (words.take_if("board")) {
    fault.way = Way::to_board;
  } else if (words.take_if("host")) {
    fault.way = Way::to_host;
  } else {
    return expected("`board` or `host` after `to`", words.peek());
  }
  return true;
}

// "0.05", "chance 0.05", "3 V", "20 ms". Whether one was there.
Result<bool> value(Words& words, const Kind& kind, Fault& fault) {
  if (kind.parameter.empty()) return false;
  const bool named = words.take_if(kind.parameter);
  const auto given = parse_number<double>(words.peek());
  const std::string name(kind.parameter);
  if (!given) {
    if (named) return expected("a number after `" + name + "`", words.peek());
    return false;
  }
  const std::string_view word = words.take();
  const double number = *given * unit_taken(words, kind);
  if (number < kind.low || number > kind.high)
    return expected("a " + name + " from " + number_text(kind.low) + " to " +
                        number_text(kind.high) + (kind.unit.empty() ? "" : " ") +
                        std::string(kind.unit) + " of `" + std::string(kind.name) + "`",
                    word);
  fault.value = number;
  return true;
}

std::string time_text(Time t) {
  return number_text(std::chrono::duration<double>(t).count()) + " s";
}

}  // namespace

Result<Fault> parse(std::string_view line, Time now) {
  Words words(line);
  Fault fault;
  fault.at = now;
  if (words.take_if("at")) {
    const auto at = KAZ_TRY(time(words, "at"));
    fault.at = at;
  }
  if (words.take_if("for")) {
    const std::string_view digits = words.peek();
    const auto length = KAZ_TRY(time(words, "for"));
    if (length == Time::zero()) return expected("a time above 0 after `for`", digits);
    fault.length = length;
  }
  const auto found = KAZ_TRY(kind(words));
  const Kind& entry = *found;
  fault.name = entry.id;
  fault.value = entry.initial;
  if (entry.target == Target::joint) {
    const auto number = KAZ_TRY(joint(words, entry));
    fault.joint = number;
  }
  // Direction and value may be in either order, each once.
  bool has_way = entry.target != Target::line, has_value = false;
  for (int i = 0; i < 2; ++i) {
    if (!has_way) has_way = KAZ_TRY(way(words, fault));
    if (!has_value) has_value = KAZ_TRY(value(words, entry, fault));
  }
  if (!words.peek().empty())
    return expected("the end of the line after `" + text_of(fault) + "`", words.peek());
  return fault;
}

std::string text_of(const Fault& fault) {
  const Kind& kind = kind_of(fault.name);
  std::string text = std::string("at ").append(time_text(fault.at));
  if (fault.length != kForEver) text.append(" for ").append(time_text(fault.length));
  text.append(" ").append(kind.name);
  if (kind.target == Target::joint) text.append(" joint ").append(std::to_string(fault.joint));
  if (!kind.parameter.empty()) {
    text.append(" ").append(kind.parameter).append(" ").append(number_text(fault.value));
    if (!kind.unit.empty()) text.append(" ").append(kind.unit);
  }
  if (fault.way == Way::to_board) text += " to board";
  if (fault.way == Way::to_host) text += " to host";
  return text;
}

Result<Schedule> Schedule::parse(std::string_view text, const std::string& name) {
  Schedule schedule;
  for (int line = 1; !text.empty(); ++line) {
    const auto end = text.find('\n');
    std::string_view words = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    words = words.substr(0, words.find('#'));
    if (Words(words).peek().empty()) continue;
    const auto fault = faults::parse(words);
    if (!fault)
      return fail(kaz::Fault::usage,
                  name + ":" + std::to_string(line) + ": " + fault.error().message);
    schedule.add(*fault);
  }
  return schedule;
}

Result<Schedule> Schedule::load(const std::string& path) {
  constexpr std::size_t max_bytes = 4 << 20;
  const auto text =
      KAZ_TRY(read_whole_file(path, max_bytes, "give a text file with one fault per line"));
  auto schedule = KAZ_TRY(parse(text, path));
  // A run without the faults that were meant would succeed for the wrong reason.
  if (schedule.faults().empty())
    return fail(kaz::Fault::usage,
                path + ": contains no fault; give a text file with one fault per line");
  return schedule;
}

}  // namespace kaz::faults
