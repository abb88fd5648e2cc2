// Parses untrusted JSON text, with a limit on the nesting depth. All programs use this parser.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_BOUNDED_JSON_HPP
#define KAZ_SHARED_BASE_BOUNDED_JSON_HPP

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/base/one_line.hpp"
#include "shared/base/result.hpp"

namespace kaz {

// Maximum nesting depth of a JSON text. The JSON files of Kaz have fewer levels than kJsonDepthMax. The
// functions of nlohmann::json that copy, compare or print a document are recursive, with one call per level.
// The stack has room for only a few thousand levels.
inline constexpr std::size_t kJsonDepthMax = 64;

enum class JsonComments { refused, ignored };

namespace bounded_json_detail {

// Checks nesting and duplicate keys. The functions of this class are callbacks of nlohmann::json's own
// parser, so the check and the parser see the same structure. A callback returns false to stop the parser;
// why() then returns the reason.
template <class Json>
class Guard final : public nlohmann::json_sax<Json> {
 public:
  explicit Guard(std::string_view text) : text_(text) {}
  const std::string& why() const { return why_; }

  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    return keys_.back().insert(name).second ||
           stop("the key \"" + cut_text(name) + "\" occurs twice in one object; remove one");
  }
  bool parse_error(std::size_t at, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    constexpr int kOutOfRange = 406;  // number overflow
    const auto before = text_.substr(0, std::min(text_.size(), at));
    const auto line = "line " + std::to_string(1 + std::ranges::count(before, '\n'));
    return stop(line + (error.id == kOutOfRange
                            ? ": the number " + cut_text(token) +
                                  " is too large: the limit is 1.8e308; give a smaller one"
                            : " is not valid JSON"));
  }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(typename Json::number_integer_t) override { return true; }
  bool number_unsigned(typename Json::number_unsigned_t) override { return true; }
  bool number_float(typename Json::number_float_t, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(typename Json::binary_t&) override { return true; }

 private:
  bool stop(std::string why) {
    why_ = std::move(why);
    return false;
  }
  bool open() {
    keys_.emplace_back();
    return keys_.size() <= kJsonDepthMax ||
           stop("it nests deeper than " + std::to_string(kJsonDepthMax) + " levels");
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  std::string_view text_;
  std::string why_;
  // One set for each open object or list. The set of an object has the keys read so far. The set of a list
  // is always empty.
  std::vector<std::set<std::string>> keys_;
};

}  // namespace bounded_json_detail

// Parses a JSON text. Returns Fault::usage for invalid JSON, too many levels, duplicate keys, or a number
// too large for a double. The error message does not name the source of the text; the caller must add the
// name.
template <class Json = nlohmann::json>
Result<Json> parse_bounded_json(std::string_view text,
                                JsonComments comments = JsonComments::refused) {
  const bool ignored = comments == JsonComments::ignored;
  bounded_json_detail::Guard<Json> guard(text);
  if (!Json::sax_parse(text, &guard, Json::input_format_t::json, true, ignored))
    return fail(Fault::usage, guard.why());
  return Json::parse(text, nullptr, false, ignored);
}

// Returns a value as text, shortened for an error message.
template <class Json>
std::string json_sample(const Json& value) {
  return cut_text(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace kaz

#endif
