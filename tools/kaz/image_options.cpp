// IMAGE, --format and --address.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/image_options.h"

#include "tools/kaz/one_of.h"

namespace kaz::tools {

void add_image_options(CLI::App& verb, std::string& path, h8s::LoadOptions& load,
                       std::uint32_t highest) {
  verb.add_option("IMAGE", path, "COFF, ELF, S-record, Intel HEX or raw")
      ->required()
      ->type_name("");
  const std::map<std::string, h8s::Format> formats{{"coff", h8s::Format::coff},
                                                   {"elf", h8s::Format::elf},
                                                   {"srec", h8s::Format::srecord},
                                                   {"ihex", h8s::Format::intel_hex},
                                                   {"raw", h8s::Format::raw}};
  verb.add_option("--format", load.format,
                  "coff, elf, srec, ihex or raw; told by the contents if not given")
      ->transform(one_of(formats))
      ->type_name("");
  verb.add_option("--address", load.address, "of a raw image's first byte, and its entry")
      ->check(CLI::Range(std::uint32_t{0}, highest))
      ->type_name("");
}

}  // namespace kaz::tools
