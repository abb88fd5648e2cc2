// Output of `kaz flash`: lines for people, or one JSON object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host/flash/flasher.h"
#include "shared/protocol/messages.h"

namespace kaz::tools {

class Answer {
 public:
  explicit Answer(bool json) : json_(json) {}

  // For people alone.
  void say(const std::string& line) const;
  // For programs alone.
  template <class T>
  void put(const char* key, const T& value) {
    object_[key] = value;
  }

  void image(const host::FlashImage& image);
  // `by_boot_mode`: that has erased the whole flash before.
  void written(const host::FlashReport& report, bool by_boot_mode);
  // Whether written() was called: the flash is whole.
  bool has_written() const { return has_written_; }
  void application(const std::optional<host::ImageIdentity>& identity);
  void runs(const kz_identify_reply& board);

  // The object, with `ok`, and of a failure `error` and the exit code.
  void finish(const std::string& verb, const Result<void>& done);

 private:
  bool json_, has_written_ = false;
  nlohmann::ordered_json object_ = nlohmann::ordered_json::object();
};

}  // namespace kaz::tools
