// One output file at a path given by the user. The file is checked and locked before a run starts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Type of an output file, and the marks by which an existing file of this type is recognized. An existing
// file is replaced only if the file is recognized or empty. If a type has neither marks nor size, only an
// empty file is replaced.
struct FileKind {
  const char* name;  // for messages: "JUnit report"
  // Texts that both occur within the first 4096 bytes of a file of this type.
  std::array<std::string_view, 2> marks{};
  std::uint64_t size = 0;  // size in bytes of every file of this type; 0: any size
};

// Type of the camera calibration that `kaz calibrate` and `kaz sim` write, as YAML or JSON.
inline constexpr FileKind kCalibrationFile{"calibration",
                                           {"camera_matrix_left", "distortion_coefficients_left"}};

// Writes to the locked file PATH.part and renames that file to PATH at the end. So PATH is never an
// incomplete file. If PATH is a symbolic link, the link stays and its target is replaced. If PATH is a
// character device, or a pipe with a reader, the bytes are written to PATH directly.
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
  // Removes PATH.part, unless commit() or failure() was called.
  ~OutputFile();

  const std::string& path() const { return path_; }
  // Path to write to before commit(). If a second Ctrl-C ends the program, PATH.part stays unless PATH.part
  // is empty.
  const std::string& part() const;
  // Returns the same path as part(). Use scratch() if the content is useless before commit(): a second Ctrl-C
  // then removes PATH.part.
  const std::string& scratch() const { return part_; }
  // Checks that the disk has room for `bytes` bytes; call this function before long work. If the disk is
  // full, check_room() returns the same error as write(). Succeeds for devices and pipes, and for file
  // systems that cannot check their free space.
  Result<void> check_room(std::uint64_t bytes);
  // Writes the complete content and calls commit(). The error message for a full disk lists the files that
  // were saved before.
  Result<void> write(std::string_view bytes);
  // Flushes the file to disk and renames it to its final path.
  Result<void> commit();
  // Call this function after a stream failed to write to part(). Returns the error. The stream does not keep
  // the reason of its failure, so this function writes again to find the reason. PATH.part stays; the error
  // message for a full disk contains its path.
  Error failure();

 private:
  OutputFile() = default;
  Result<void> open_stream(const std::string& option);
  Result<bool> lock_part(const std::string& option, const FileKind& kind);
  void release();

  // target_: file that path_ points to; empty for a device or pipe.
  std::string path_, target_, part_;
  int fd_ = -1;
  int at_last_ = -1;  // number that remove_file_at_last() returned
};

}  // namespace kaz::tools
