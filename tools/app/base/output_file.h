// One file of a result, at a path of the user's: checked and locked before a run starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Grows at PATH.part, which is locked, and is renamed at the end: nothing half-written is ever at PATH. A
// symbolic link stays, and the file that it points to is replaced. A device or pipe takes the bytes itself.
class OutputFile {
 public:
  // `option` names the file in errors: "--json". Errors:
  // - usage: the file cannot be created there
  // - environment: another process writes it; the disk is full
  static Result<OutputFile> open(const std::string& path, const std::string& option);
  OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }
  OutputFile& operator=(OutputFile&& other) noexcept;
  // Without commit() nothing is left.
  ~OutputFile();

  const std::string& path() const { return path_; }
  // Where to write until commit().
  const std::string& part() const { return part_; }
  // All bytes of the file, and commit().
  Result<void> write(std::string_view bytes);
  // Puts the file in its place.
  Result<void> commit();
  // The error of a stream on part(), which does not keep its reason: that of writing there once more. What is
  // there stays, and is named.
  Error failure();

 private:
  OutputFile() = default;
  Result<bool> lock_part(const std::string& option);
  void release();

  std::string path_, target_, part_;  // target_: what path_ points to; empty for a device or pipe
  int fd_ = -1;
};

}  // namespace kaz::tools
