// Pictures into a file of a film, by the program ffmpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"
#include "tools/app/base/child.h"
#include "tools/app/base/output.h"
#include "tools/app/base/output_file.h"

namespace kaz::tools {

struct FilmFormat {
  const char* ending;                // ".mp4"
  FileKind kind;                     // which files it may replace
  int fps;                           // where none is asked for
  std::vector<std::string> options;  // of ffmpeg, behind those of its input
};

// Error (usage): the ending is of no format; it lists those that are.
Result<FilmFormat> film_format(const std::string& path);

struct FilmSize {
  int width = 0, height = 0, fps = 0;
};

// ffmpeg is a process of its own, which ends with the object.
class FilmEncoder {
 public:
  // ffmpeg replaces what is at `path`. `interrupt` must outlive the encoder.
  static Result<FilmEncoder> begin(const FilmFormat& format, const FilmSize& size,
                                   const std::string& path, const host::Interrupt& interrupt);

  // One picture: rows from top to bottom, 3 bytes a pixel. Errors: interrupted; environment: ffmpeg is not
  // installed, or has ended with an error, whose last line is in the sentence.
  Result<void> add(std::span<const std::uint8_t> rgb);
  // Returns when the file is complete. Errors as of add().
  Result<void> finish();

 private:
  FilmEncoder(Child child, Descriptor input, std::string log, const host::Interrupt& interrupt)
      : child_(std::move(child)),
        input_(std::move(input)),
        log_(std::move(log)),
        interrupt_(&interrupt) {}
  Error failure();

  Child child_;
  Descriptor input_;
  std::string log_;  // standard error of ffmpeg
  const host::Interrupt* interrupt_;
};

}  // namespace kaz::tools
