#!/usr/bin/env python3
# Writes golden vectors of the protocol, by a codec of its own, as JSON that any language can read.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_vectors.py ROOT [--check]

Writes ROOT/shared/protocol/vectors.json; with --check only compares, and fails if it is out of date.

  messages  a message, the values of its fields, the frame's body, and its bytes on the wire. A masked
            field has one number for each bit of its mask. `out_of_bounds`: number of the first field
            for which a board refuses it, null if it is within its bounds.
  bodies    bodies of no message: each length, each place of a zero, each length of a stuffed block.
  streams   bytes on the wire, and what a receiver makes of them that has heard nothing before:
            results in order, for FRAME with the body. `errors`: place in the stream and error of the
            byte there (PARITY, FRAMING; LOST: bytes before it are gone; OVERRUN: bytes behind it).
            `silence_ms`: place, and the silence before the byte there.
"""
import json
import random
import sys

import generated_file
from protocol_table import (BODY_MAX, HEADER_SIZE, JOINTS, all_constants, check_of, frame_of,
                            joints_of, out_of_bounds, pack, read_messages, received, stuff, value_of)

MASKS = {"none": 0, "first": 1, "last": 1 << 17, "odd": 0x2AAAA, "nine": 0x1FF, "all": 0x3FFFF}


def values_of(message, choose, mask):
    values = {}
    for field in message.fields:
        if any(other.mask == field.name for other in message.fields):
            values[field.name] = mask
        elif field.kind == "one":
            values[field.name] = choose(field)
        else:
            values[field.name] = [choose(field) for _ in range(
                JOINTS if field.kind == "masked" else field.most)]
    return values


def message_vector(name, message, values, address, sequence):
    body = bytes([address, message.code, sequence]) + pack(message, values)
    fields = {field.name: values[field.name] if field.kind != "masked" else
            [values[field.name][joint] for joint in joints_of(values[field.mask], field.most)]
            for field in message.fields}
    return {"name": f"{message.name}: {name}", "message": message.name, "address": address,
            "sequence": sequence, "fields": fields, "out_of_bounds": out_of_bounds(message, values),
            "body": body.hex(), "wire": frame_of(body).hex()}


def message_vectors(message, rng):
    def any_of(field):
        return rng.randint(field.low, field.high)
    masked = [field for field in message.fields if field.kind == "masked"]
    choices = {"typical": any_of} if not message.fields else {
        "lowest": lambda field: field.low, "highest": lambda field: field.high, "typical": any_of,
        "near zero": lambda field: min(max(rng.choice([-1, 0, 0, 1, 256]), field.low), field.high)}
    most = min([field.most for field in masked], default=JOINTS)
    out = []
    for name, choose in choices.items():
        mask = rng.choice([mask for mask in MASKS.values() if bin(mask).count("1") <= most])
        out.append(message_vector(name, message, values_of(message, choose, mask),
                                  rng.randint(1, 14), rng.randint(0, 255)))
    if masked:
        for name, mask in MASKS.items():
            out.append(message_vector(f"mask {name}", message, values_of(message, any_of, mask),
                                      1, rng.randint(0, 255)))
    for field in message.fields:
        ends = {"low": -0x8000 if field.type == "s16" else 0,
                "high": {"u8": 0xFF, "u16": 0xFFFF, "s16": 0x7FFF, "u32": 0xFFFFFFFF}[field.type]}
        for value, within in ((field.low - 1, field.low > ends["low"]),
                              (field.high + 1, field.high < ends["high"])):
            if not within:
                continue
            values = values_of(message, any_of, 0x15)
            values[field.name] = value
            out.append(message_vector(f"{field.name} = {value}", message, values, 1,
                                      rng.randint(0, 255)))
    return out


def body_vectors(rng):
    bodies = {}
    for length in range(HEADER_SIZE, BODY_MAX + 1):
        bodies[f"{length} bytes without a zero"] = bytes(rng.randint(1, 255) for _ in range(length))
    for place in range(BODY_MAX):
        body = bytearray(rng.randint(1, 255) for _ in range(BODY_MAX))
        body[place] = 0
        bodies[f"a zero as byte {place} of {BODY_MAX}"] = bytes(body)
    for length in (HEADER_SIZE, 10, 50, BODY_MAX):
        bodies[f"{length} zeros"] = bytes(length)
        bodies[f"{length} times ff"] = b"\xff" * length
        bodies[f"{length} bytes, every other one a zero"] = bytes(i % 2 for i in range(length))
    return [{"name": name, "body": body.hex(), "wire": frame_of(body).hex()}
            for name, body in bodies.items()]


def stream(name, wire, results, **more):
    return {"name": name, "wire": bytes(wire).hex(), **more,
            "results": [[result] if body is None else [result, body.hex()]
                        for result, body in results]}


def damaged(name, wire):
    return stream(name, wire, received(wire))


def streams(rng, idle_ms):
    body = bytes([1, 3, 9, 0, 0, 0, 3, 1, 0xF4, 3, 0xE8, 0xFF, 0xFE])
    valid, after = frame_of(body), frame_of(bytes([1, 5, 10]))
    out = [damaged("two frames", valid + after),
           damaged("two frames share a zero", valid[:-1] + after),
           damaged("zeros between frames", valid + bytes(20) + after),
           damaged("noise before the first zero", b"\x12\x34\x56" + valid),
           damaged("half a frame, then a whole one", valid[5:] + valid),
           damaged("a frame without an end", valid[:-1]),
           damaged("one byte too long", b"\0" + b"\x11" * (BODY_MAX + 5) + b"\0" + after),
           damaged("far too long", b"\0" + b"\x11" * 700 + b"\0" + after),
           damaged("the longest that is not too long", b"\0" + b"\x11" * (BODY_MAX + 4) + b"\0")]
    for length in range(1, 4):
        out.append(damaged(f"{length} bytes", b"\0" + b"\x81" * length + b"\0" + after))
    for length in range(HEADER_SIZE):
        out.append(damaged(f"a body of {length} bytes, check right", frame_of(bytes(range(length)))
                           + after))
    for stuffed in (b"\x05\x01\x05\x01", b"\xff\x01\x05\x01", stuff(body)[:-1],
                    stuff(body) + b"\x02", b"\x01\x01\x01\x02"):
        wire = b"\0" + stuffed + check_of(stuffed) + b"\0" + after
        out.append(damaged("stuffing that does not come out, check right: " + stuffed.hex(), wire))
    for place in range(len(valid)):
        for name, byte in (("a flipped bit", valid[place] ^ 1 << rng.randint(0, 7)), ("a zero", 0)):
            if byte != valid[place]:
                wire = valid[:place] + bytes([byte]) + valid[place + 1:]
                out.append(damaged(f"{name} in byte {place}", wire + after))
        out.append(damaged(f"byte {place} lost", valid[:place] + valid[place + 1:] + after))
        extra = bytes([rng.randint(0, 255)])
        out.append(damaged(f"{extra.hex()} before byte {place}",
                           valid[:place] + extra + valid[place:] + after))
    for error, result in (("PARITY", "LINE_ERROR"), ("FRAMING", "LINE_ERROR"), ("LOST", "OVERRUN"),
                          ("OVERRUN", "OVERRUN")):
        for place in (1, len(valid) // 2, len(valid) - 2):
            out.append(stream(f"{error} at byte {place}", valid + after,
                              [(result, None), *received(after)], errors=[[place, error]]))
    for pause, results in ((idle_ms - 1, received(valid + after)),
                           (idle_ms, [("IDLE", None), *received(after)])):
        for place in (2, len(valid) // 2, len(valid) - 1):
            out.append(stream(f"{pause} ms before byte {place}", valid + after, results,
                              silence_ms=[[place, pause]]))
        out.append(stream(f"{pause} ms between frames", valid + after, received(valid + after),
                          silence_ms=[[len(valid), pause]]))
    return out


def vectors(root):
    # Numbers of its own for each message: a new one leaves the vectors of the others alone.
    parts = {"messages": [vector for message in read_messages(root)
                          for vector in message_vectors(message, random.Random(message.name))],
             "bodies": body_vectors(random.Random("bodies")),
             "streams": streams(random.Random("streams"),
                                value_of("KZ_IDLE_MS", all_constants(root), "frame.h"))}
    blocks = [f' "{name}": [\n' + ",\n".join("  " + json.dumps(row) for row in rows) + "]"
              for name, rows in parts.items()]
    return ('{"about": "Golden vectors of Kaz\'s protocol, made and explained by '
            'tools/repo/gen/protocol_vectors.py",\n' + ",\n".join(blocks) + "}\n")


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "shared/protocol/vectors.json", vectors))
