// Output of `kaz flash`: lines for users, or one JSON object.
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

  // Prints a line, unless the output is JSON.
  void say(const std::string& line) const;
  // Adds a member to the JSON object.
  template <class T>
  void put(const char* key, const T& value) {
    object_[key] = value;
  }

  void image(const host::FlashImage& image);
  // Reports a completed write. `by_boot_mode`: the flash was written through boot mode, which first erased
  // the whole flash.
  void written(const host::FlashReport& report, bool by_boot_mode);
  // Returns whether written() was called. If so, the flash is complete.
  bool has_written() const { return has_written_; }
  void application(const std::optional<host::ImageIdentity>& identity);
  void runs(const kz_identify_reply& board);

  // Prints the JSON object with the member `ok`. After a failure, adds `error` and the exit code. Prints
  // nothing if the output is not JSON.
  void finish(const std::string& verb, const Result<void>& done);

 private:
  bool json_, has_written_ = false;
  nlohmann::ordered_json object_ = nlohmann::ordered_json::object();
};

}  // namespace kaz::tools
