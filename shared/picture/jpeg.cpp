// libjpeg, into and from memory.
// SPDX-License-Identifier: Apache-2.0
#include "shared/picture/jpeg.h"

#include <csetjmp>
#include <cstdio>  // before jpeglib.h, which needs it
#include <new>
#include <string>
#include <utility>

#include <jpeglib.h>
// After it: the codes of its messages.
#include <jerror.h>

#include "shared/picture/exif.h"

namespace kaz::picture {
namespace {

// More than any program writes. Each costs a pass over all pixels, and may take a few bytes alone.
constexpr int kMaxJpegScans = 100;

constexpr unsigned kLongestSegment = 0xffff;  // bytes; the length field of a segment has 16 bits

// libjpeg reports errors by longjmp into a member function of the classes below: nothing with a destructor
// may live in its frame.
struct JpegErrors {
  jpeg_error_mgr manager;  // first: libjpeg knows only of it
  std::jmp_buf give_up;
  char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void leave_jpeg(j_common_ptr common) {
  auto* errors = reinterpret_cast<JpegErrors*>(common->err);
  errors->manager.format_message(common, errors->text);
  std::longjmp(errors->give_up, 1);
}

class JpegEncoder {
 public:
  JpegEncoder() = default;
  ~JpegEncoder() { jpeg_destroy_compress(&jpeg_); }
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  // False: what() is the reason.
  bool write(const PixelView& pixels, const JpegSettings& settings) {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = leave_jpeg;
    if (setjmp(errors_.give_up)) return false;
    jpeg_create_compress(&jpeg_);
    output_.init_destination = begin;
    output_.empty_output_buffer = append_full;
    output_.term_destination = append_rest;
    jpeg_.dest = &output_;
    jpeg_.image_width = static_cast<JDIMENSION>(pixels.width);
    jpeg_.image_height = static_cast<JDIMENSION>(pixels.height);
    jpeg_.input_components = pixels.channels;
    jpeg_.in_color_space = pixels.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg_);
    jpeg_set_quality(&jpeg_, settings.quality, TRUE);
    jpeg_.optimize_coding = settings.optimized_tables ? TRUE : FALSE;
    jpeg_start_compress(&jpeg_, TRUE);
    const std::size_t row_bytes = bytes_per_row(pixels);
    while (jpeg_.next_scanline < jpeg_.image_height) {
      // Read only, in spite of its type.
      auto* row = const_cast<JSAMPLE*>(pixels.samples.data() + jpeg_.next_scanline * row_bytes);
      jpeg_write_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_compress(&jpeg_);
    return true;
  }
  const char* what() const { return errors_.text; }
  std::vector<std::uint8_t> take() { return std::move(output_.bytes); }

 private:
  // Not jpeg_mem_dest: what it has allocated cannot be freed safely after an error.
  struct Output : jpeg_destination_mgr {
    std::vector<std::uint8_t> bytes;
    JOCTET buffer[16384];
  };

  static Output& output(j_compress_ptr jpeg) { return static_cast<Output&>(*jpeg->dest); }
  static void begin(j_compress_ptr jpeg) {
    Output& out = output(jpeg);
    out.next_output_byte = out.buffer;
    out.free_in_buffer = sizeof out.buffer;
  }
  // No exception may pass through libjpeg's frames.
  static void append(j_compress_ptr jpeg, std::size_t size) {
    Output& out = output(jpeg);
    bool enough = true;
    try {
      out.bytes.insert(out.bytes.end(), out.buffer, out.buffer + size);
    } catch (const std::bad_alloc&) {
      enough = false;
    }
    if (!enough) ERREXIT1(jpeg, JERR_OUT_OF_MEMORY, 0);
  }
  // libjpeg leaves the count of free bytes as it is: the whole buffer is full.
  static boolean append_full(j_compress_ptr jpeg) {
    append(jpeg, sizeof output(jpeg).buffer);
    begin(jpeg);
    return TRUE;
  }
  static void append_rest(j_compress_ptr jpeg) {
    append(jpeg, sizeof output(jpeg).buffer - output(jpeg).free_in_buffer);
  }

  JpegErrors errors_{};
  Output output_{};
  jpeg_compress_struct jpeg_{};
};

// The caller allocates the pixels between header() and pixels(), by the size that libjpeg itself has read;
// a size found by any other means may differ from what libjpeg then writes.
class JpegDecoder {
 public:
  explicit JpegDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg_); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  // Reads up to the first scan. False: what() is the reason.
  bool header() {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = leave_jpeg;
    errors_.manager.emit_message = warn;
    if (setjmp(errors_.give_up)) return false;
    jpeg_create_decompress(&jpeg_);
    progress_.progress_monitor = count_scans;
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, bytes_.data(), bytes_.size());
    jpeg_save_markers(&jpeg_, JPEG_APP0 + 1, kLongestSegment);
    jpeg_read_header(&jpeg_, TRUE);
    // Read here, because jpeg_finish_decompress() frees the segments.
    if (const jpeg_saved_marker_ptr app1 = jpeg_.marker_list; app1 != nullptr)
      orientation_ = exif_orientation({app1->data, app1->data_length});
    return true;
  }
  std::uint64_t width() const { return jpeg_.image_width; }
  std::uint64_t height() const { return jpeg_.image_height; }
  // Orientation by the first APP1 segment, as OpenCV reads it.
  int orientation() const { return orientation_; }

  // `rgb` has room for width() * height() * 3 bytes. False: what() is the reason.
  bool pixels(std::span<std::uint8_t> rgb) {
    if (setjmp(errors_.give_up)) return false;
    jpeg_.out_color_space = JCS_RGB;
    jpeg_.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&jpeg_);
    const std::size_t row_bytes = std::size_t{jpeg_.output_width} * 3;
    if (jpeg_.output_components != 3 || row_bytes * jpeg_.output_height != rgb.size()) {
      std::snprintf(errors_.text, sizeof errors_.text, "its pixels do not match its size");
      return false;
    }
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = rgb.data() + jpeg_.output_scanline * row_bytes;
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return true;
  }
  const char* what() const { return errors_.text; }

 private:
  // A warning (level -1) means that data are damaged or missing and were made up. Some cameras write
  // a few bytes too many between two parts: those may be there.
  static void warn(j_common_ptr common, int level) {
    const int code = common->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR) leave_jpeg(common);
  }
  static void count_scans(j_common_ptr common) {
    if (reinterpret_cast<j_decompress_ptr>(common)->input_scan_number <= kMaxJpegScans) return;
    auto* errors = reinterpret_cast<JpegErrors*>(common->err);
    std::snprintf(errors->text, sizeof errors->text, "more than %d scans", kMaxJpegScans);
    std::longjmp(errors->give_up, 1);
  }

  std::span<const std::uint8_t> bytes_;
  JpegErrors errors_{};
  jpeg_progress_mgr progress_{};
  int orientation_ = 1;
  jpeg_decompress_struct jpeg_{};
};

}  // namespace

Result<std::vector<std::uint8_t>> encode_jpeg(const PixelView& pixels,
                                              const JpegSettings& settings) {
  if (!valid(pixels) || pixels.bits != 8 || pixels.width > JPEG_MAX_DIMENSION ||
      pixels.height > JPEG_MAX_DIMENSION)
    return fail(Fault::usage, "a picture of " + std::to_string(pixels.width) + " x " +
                                  std::to_string(pixels.height) + " cannot be a JPEG file");
  JpegEncoder encoder;
  if (!encoder.write(pixels, settings))
    return fail(Fault::failed, std::string("cannot encode the picture as JPEG: ") + encoder.what());
  return encoder.take();
}

Decoded decode_jpeg(std::span<const std::uint8_t> bytes, const SizeLimits& limits) {
  JpegDecoder decoder(bytes);
  const auto error = [&](DecodeError::Kind kind) {
    return tl::unexpected(DecodeError{kind, decoder.what(), decoder.width(), decoder.height()});
  };
  if (!decoder.header()) return error(DecodeError::Kind::invalid);
  if (!within(limits, decoder.width(), decoder.height())) return error(DecodeError::Kind::size);
  Image picture{static_cast<int>(decoder.width()), static_cast<int>(decoder.height()), {}};
  picture.rgb.resize(decoder.width() * decoder.height() * 3);
  if (!decoder.pixels(picture.rgb)) return error(DecodeError::Kind::invalid);
  return turned_upright(std::move(picture), decoder.orientation());
}

}  // namespace kaz::picture
