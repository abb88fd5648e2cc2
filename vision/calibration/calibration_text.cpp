// The keys and numbers of a calibration file.
// SPDX-License-Identifier: Apache-2.0
#include "vision/calibration/calibration_text.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace kaz::vision {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

// One word or sign after the other; nothing at the end.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::string_view next() {
    skip();
    if (at_ >= text_.size()) return {};
    const std::size_t begin = at_;
    const char c = text_[at_++];
    if (c == '"' || c == '\'') {
      const std::size_t end = std::min(text_.find(c, at_), text_.size());
      const std::string_view word = text_.substr(at_, end - at_);
      at_ = std::min(end + 1, text_.size());
      return word.empty() ? std::string_view("\"\"") : word;
    }
    if (sign(c)) return text_.substr(begin, 1);
    while (at_ < text_.size() && !sign(text_[at_]) &&
           kBlank.find(text_[at_]) == std::string_view::npos)
      ++at_;
    return text_.substr(begin, at_ - begin);
  }
  // Whether the next sign is `c`.
  bool before(char c) {
    skip();
    return at_ < text_.size() && text_[at_] == c;
  }
  // Whether the next word is a key, as below the key of a matrix of ROS.
  bool before_key() const {
    Words ahead = *this;
    ahead.next();
    return ahead.before(':');
  }

 private:
  static bool sign(char c) {
    return c == ':' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}';
  }
  void skip() {
    while (at_ < text_.size()) {
      if (kBlank.find(text_[at_]) != std::string_view::npos) {
        ++at_;
      } else if (text_[at_] == '#') {  // a comment
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        return;
      }
    }
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

bool of_a_matrix(std::string_view key) {
  return key == "rows" || key == "cols" || key == "dt" || key == "type_id";
}

}  // namespace

std::map<std::string, CalibrationEntry, std::less<>> scan_calibration(std::string_view content) {
  std::map<std::string, CalibrationEntry, std::less<>> entries;
  // The first line of OpenCV's YAML has a colon of its own.
  if (content.starts_with("%YAML"))
    content.remove_prefix(std::min(content.find('\n'), content.size()));
  Words words(content);
  CalibrationEntry* entry = nullptr;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (!words.before(':')) continue;
    words.next();
    // `data` and the words around it speak of the matrix whose key came before.
    if (!of_a_matrix(word) && !(word == "data" && entry != nullptr)) {
      entry = &entries.try_emplace(std::string(word)).first->second;
      if (++entry->times > 1) continue;
    }
    if (entry != nullptr && entry->times == 1 && (word == "rows" || word == "cols")) {
      std::string_view& count = word == "rows" ? entry->rows : entry->cols;
      if (!count.empty()) entry->repeated = word;
      count = words.next();
      continue;
    }
    if (entry == nullptr || of_a_matrix(word)) continue;
    if (!words.before('[')) {
      if (word == "data" || words.before('{') || words.before_key()) continue;
      entry->values.assign(1, words.next());
      if (entry->values.front().starts_with("!!")) entry->values.clear();
      continue;
    }
    words.next();
    if (entry->list) entry->repeated = word;
    entry->list = true;
    entry->closed = false;
    entry->values.clear();
    for (word = words.next(); !word.empty(); word = words.next()) {
      if (word == "]") {
        entry->closed = true;
        break;
      }
      if (word != ",") entry->values.push_back(word);
    }
  }
  return entries;
}

bool calibration_number(std::string_view value, double& number) {
  if (value.starts_with('+')) value.remove_prefix(1);
  const bool minus = value.starts_with('-');
  const std::string_view bare = value.substr(minus ? 1 : 0);
  if (bare == ".Nan" || bare == ".nan" || bare == ".NaN" || bare == ".Inf" || bare == ".inf") {
    number =
        std::numeric_limits<double>::quiet_NaN();  // neither is finite, which is all that counts
    return true;
  }
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error == std::errc::result_out_of_range) number = std::numeric_limits<double>::infinity();
  return (error == std::errc() || error == std::errc::result_out_of_range) &&
         end == value.data() + value.size();
}

}  // namespace kaz::vision
