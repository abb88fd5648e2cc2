// One file of a result, at a path of the user's: checked and locked before a run starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// What Kaz writes into a file, and how it recognises one that it wrote earlier: only such a file, or an empty
// one, is replaced. Without marks and size no file is.
struct FileKind {
  const char* name;                         // "JUnit report"
  std::array<std::string_view, 2> marks{};  // both are within the first 4096 bytes
  std::uint64_t size = 0;                   // of every such file; 0: any
};

// Of kaz calibrate and kaz sim, YAML or JSON.
inline constexpr FileKind kCalibrationFile{"calibration",
                                           {"camera_matrix_left", "distortion_coefficients_left"}};

// Grows at PATH.part, which is locked, and is renamed at the end: nothing half-written is ever at PATH. A
// symbolic link stays, and the file that it points to is replaced. A character device or a pipe that is being
// read takes the bytes itself.
class OutputFile {
 public:
  // `option` names the file in errors: "--json". Errors:
  // - usage: the file cannot be created there, would replace one that is not of this kind, or would be among
  //   the results of a run (output_folder.h)
  // - environment: another process writes it; the disk is full
  static Result<OutputFile> open(const std::string& path, const std::string& option,
                                 const FileKind& kind);
  OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }
  OutputFile& operator=(OutputFile&& other) noexcept;
  // Without commit() nothing is left; nor if a signal ends the program at once (interrupt_signals.h).
  ~OutputFile();

  const std::string& path() const { return path_; }
  // Where to write until commit(). What is there stays if a second Ctrl-C ends the program.
  const std::string& part() const;
  // The same for a file that is useless before commit(): a second Ctrl-C removes it, too.
  const std::string& scratch() const { return part_; }
  // Whether so many bytes have room, of a file that takes long to obtain. Error: as of write() on a full
  // disk. Devices, pipes and file systems that cannot say so have room.
  Result<void> check_room(std::uint64_t bytes);
  // All bytes of the file, and commit(). The error of a full disk names the files that are saved.
  Result<void> write(std::string_view bytes);
  // Puts the file in its place.
  Result<void> commit();
  // The error of a stream on part(), which does not keep its reason: that of writing there once more. What is
  // there stays, and is named.
  Error failure();

 private:
  OutputFile() = default;
  Result<void> open_stream(const std::string& option);
  Result<bool> lock_part(const std::string& option, const FileKind& kind);
  void release();

  std::string path_, target_, part_;  // target_: what path_ points to; empty for a device or pipe
  int fd_ = -1;
  int at_last_ = -1;  // remove_file_at_last()
};

}  // namespace kaz::tools
