// The one place where JSON texts from outside are parsed, with a limit on nesting.
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

// More than any file of ours has. Copies, comparisons and texts of a parsed document recurse once a level,
// and a stack takes some thousand.
inline constexpr std::size_t kJsonDepthMax = 64;

enum class JsonComments { refused, ignored };

namespace bounded_json_detail {

// Receives the parser's own events, so that it and the parser cannot differ on what a bracket is. Stops the
// parser by returning false; `why` is the reason.
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
    return keys_.back().insert(name).second || stop("\"" + cut_text(name) + "\" is there twice");
  }
  bool parse_error(std::size_t at, const std::string&,
                   const nlohmann::detail::exception& error) override {
    constexpr int kOutOfRange = 406;  // a number
    const auto before = text_.substr(0, std::min(text_.size(), at));
    const auto line = "line " + std::to_string(1 + std::ranges::count(before, '\n'));
    return stop(line + (error.id == kOutOfRange ? " has a number that is too large" : " is no JSON"));
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
  std::vector<std::set<std::string>> keys_;  // of the objects and lists that are open
};

}  // namespace bounded_json_detail

// The value of a JSON text. Errors (usage), as the rest of a sentence about its source: no JSON, with the
// line; too many levels; a number too large for a double; a key that is there twice.
template <class Json = nlohmann::json>
Result<Json> parse_bounded_json(std::string_view text,
                                JsonComments comments = JsonComments::refused) {
  const bool ignored = comments == JsonComments::ignored;
  bounded_json_detail::Guard<Json> guard(text);
  if (!Json::sax_parse(text, &guard, Json::input_format_t::json, true, ignored))
    return fail(Fault::usage, guard.why());
  return Json::parse(text, nullptr, false, ignored);
}

// A value as part of an error's sentence.
template <class Json>
std::string json_sample(const Json& value) {
  return cut_text(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace kaz

#endif
