// Cases made from the message table: form of each reply, lengths, bounds of each field.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

// Requests not sent with legal fields as such: they restart the board, write flash, or drive a motor.
bool is_drastic(const Message& request) {
  return request.kind == KZ_KIND_RESTART_COMMAND || request.kind == KZ_KIND_FLASH_COMMAND ||
         request.code == KZ_TYPE_raw_drive;
}

void add_form(Cases& to, const Message& request) {
  if (is_drastic(request)) return;
  to.push_back(
      {"reply." + request.name,
       "The reply to `" + request.name + "` has the right type, sequence number, length and tick.",
       {"REQ-1", "REQ-6"},
       kNothing,
       [&request](Board& b) {
         const long before = b.state()["tick"];
         const Reply reply = b.done(request.name, legal_fields(request));
         const long after = b.state()["tick"];
         within("tick", reply["tick"], before, after);
         b.silence(10);
       }});
}

void add_lengths(Cases& to, const Message& request) {
  to.push_back({"length." + request.name + ".long",
                "`" + request.name + "` with one or two extra bytes is refused with LENGTH.",
                {"REQ-4"},
                kNothing,
                [&request](Board& b) {
                  Bytes fields = legal_fields(request);
                  for (const std::size_t more : {1u, 2u}) {
                    fields.resize(fields.size() + more);
                    b.refused(request.name, fields, KZ_REFUSED_LENGTH, kNoDetail);
                  }
                  equal("reason of a shutdown", b.state().reason(), KZ_SHUTDOWN_NONE);
                }});
  if (request.fields.empty()) return;
  to.push_back({"length." + request.name + ".short",
                "`" + request.name +
                    "` without its last byte, or without any fields, is refused with LENGTH.",
                {"REQ-4"},
                kNothing,
                [&request](Board& b) {
                  Bytes fields = legal_fields(request);
                  fields.pop_back();
                  b.refused(request.name, fields, KZ_REFUSED_LENGTH, kNoDetail);
                  b.refused(request.name, {}, KZ_REFUSED_LENGTH, kNoDetail);
                }});
}

// A masked number too few and one too many for the mask.
void add_masked_lengths(Cases& to, const Message& request) {
  bool masked = false;
  for (const Field& field : request.fields) masked |= field.masked;
  if (!masked) return;
  to.push_back({"length." + request.name + ".mask",
                "`" + request.name +
                    "` is refused with LENGTH if the number of values differs from the "
                    "number of bits set in its mask.",
                {"REQ-4"},
                kNothing,
                [&request](Board& b) {
                  Bytes fields = legal_fields(request, 0, 0x3);
                  fields.resize(fields.size() - 2);
                  b.refused(request.name, fields, KZ_REFUSED_LENGTH, kNoDetail);
                  fields.resize(fields.size() + 4);
                  b.refused(request.name, fields, KZ_REFUSED_LENGTH, kNoDetail);
                }});
}

void add_bounds(Cases& to, const Message& request, int index) {
  const Field& field = request.fields[static_cast<std::size_t>(index)];
  const std::string name = request.name + "." + field.name;
  const auto outside = [&](const char* side, long value) {
    if (value < field.lowest() || value > field.highest()) return;
    to.push_back({"range." + name + "." + side,
                  "If `" + name + "` is " + side +
                      " its range, the request is refused with RANGE, and `detail` is the number "
                      "of the field.",
                  {"REQ-5"},
                  kNothing,
                  [&request, index, value](Board& b) {
                    b.refused(request.name, legal_fields(request, index, value), KZ_REFUSED_RANGE,
                              index);
                  }});
  };
  outside("below", field.low - 1);
  outside("above", field.high + 1);

  // The bounds themselves are taken, or refused for another reason (no unlock, joints off).
  if (request.kind == KZ_KIND_RESTART_COMMAND) return;
  if (request.code == KZ_TYPE_calibrate) return;  // has bounds of its own for what the mask selects
  const bool moves = request.code == KZ_TYPE_enable;
  long high = field.high;
  if (request.code == KZ_TYPE_joints) high = (1 << KZ_JOINTS_PER_REPLY) - 1;
  to.push_back(
      {"range." + name + ".inside",
       "If `" + name +
           "` is at the lower or upper end of its range, the request is not refused with RANGE.",
       {"REQ-5"},
       moves ? kMotion : kNothing,
       [&request, index, low = field.low, high](Board& b) {
         for (const long value : {low, high}) {
           const Frame frame = b.raw_request(request.code, legal_fields(request, index, value));
           if (frame.type != KZ_TYPE_refused) continue;
           const Reply refusal(message("refused"), frame);
           check(refusal["reason"] != KZ_REFUSED_RANGE && refusal["reason"] != KZ_REFUSED_LENGTH,
                 "the value " + std::to_string(value) + " is refused with reason " +
                     std::to_string(refusal["reason"]));
         }
       }});
}

}  // namespace

void add_table_cases(Cases& to) {
  for (const Message& request : messages()) {
    if (!request.is_request()) continue;
    add_form(to, request);
    add_lengths(to, request);
    add_masked_lengths(to, request);
    for (std::size_t i = 0; i < request.fields.size(); ++i) {
      if (request.fields[i].bounded) add_bounds(to, request, static_cast<int>(i));
    }
  }
}

}  // namespace kaz::hil
