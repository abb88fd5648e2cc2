// One output file at a path given by the user: checked and locked before a run starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Type of an output file, and how an earlier file of this type is recognized. Only a recognized or an empty
// file is replaced. Without marks and size, no file with content is recognized.
struct FileKind {
  const char* name;                         // for messages: "JUnit report"
  std::array<std::string_view, 2> marks{};  // both occur within the first 4096 bytes
  std::uint64_t size = 0;                   // exact size of every such file; 0: any
};

// Written by kaz calibrate and kaz sim, as YAML or JSON.
inline constexpr FileKind kCalibrationFile{"calibration",
                                           {"camera_matrix_left", "distortion_coefficients_left"}};

// Writes to PATH.part, which is locked, and renames it at the end: PATH never contains an incomplete file. A
// symbolic link stays; its target is replaced. A character device, or a pipe with a reader, is written
// directly.
class OutputFile {
 public:
  // `option` names the file in errors: "--json". Errors:
  // - usage: the file cannot be created, would replace a file of another type, or would be in a folder of
  //   results (output_folder.h).
  // - environment: another process writes the file, or the disk is full.
  static Result<OutputFile> open(const std::string& path, const std::string& option,
                                 const FileKind& kind);
  OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }
  OutputFile& operator=(OutputFile&& other) noexcept;
  // Without commit() or failure() removes the part.
  ~OutputFile();

  const std::string& path() const { return path_; }
  // Path to write to until commit(). If a second Ctrl-C ends the program, the part stays unless it is empty.
  const std::string& part() const;
  // The same path, for a part that is useless before commit(): a second Ctrl-C removes it.
  const std::string& scratch() const { return part_; }
  // Checks that `bytes` fit on the disk, before long work. Fails like write() on a full disk. Succeeds for
  // devices, pipes and file systems that cannot check this.
  Result<void> check_room(std::uint64_t bytes);
  // Writes the complete content and calls commit(). The error of a full disk lists the files saved so far.
  Result<void> write(std::string_view bytes);
  // Flushes the file to disk and renames it to its final path.
  Result<void> commit();
  // Returns the error after a stream on part() failed. The stream does not keep the reason, so this function
  // writes again to get it. The part stays; the error of a full disk names it.
  Error failure();

 private:
  OutputFile() = default;
  Result<void> open_stream(const std::string& option);
  Result<bool> lock_part(const std::string& option, const FileKind& kind);
  void release();

  // Target_: file that path_ points to; empty for a device or pipe.
  std::string path_, target_, part_;
  int fd_ = -1;
  int at_last_ = -1;  // number from remove_file_at_last()
};

}  // namespace kaz::tools
