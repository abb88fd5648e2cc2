-- Wireshark dissector of Kaz's protocol, made by tools/repo/gen/protocol_dissector.py; change that.
-- SPDX-License-Identifier: Apache-2.0
--
-- Use: wireshark -X lua_script:kaz.lua capture.pcap, or copy this file to the folder of personal Lua
-- plugins. A packet is one frame as on the wire, with or without its zeros; link type USER0 (147).
-- examples/python/kaz_pcap.py makes such a capture from the bytes of a serial line.

local messages = {
  [1] = {name = "identify", fields = {
  }},
  [129] = {name = "identify_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "protocol_version", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "joints", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "capabilities", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "firmware_version", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "build_id", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "image_crc", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "reset_cause", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "watchdog_10ms", kind = "u8", size = 1, count = 1, unit = "10 ms"},
    {name = "reaction", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [9] = {name = "health", fields = {
  }},
  [137] = {name = "health_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "detail", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "shutdown_tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "supply_mv", kind = "u16", size = 2, count = 1, unit = "mV"},
    {name = "supply_lowest_mv", kind = "u16", size = 2, count = 1, unit = "mV"},
    {name = "temperature_dc", kind = "s16", size = 2, count = 1, unit = "0.1 degC"},
    {name = "reference", kind = "u16", size = 2, count = 1, unit = "1/1024"},
  }},
  [10] = {name = "statistics", fields = {
  }},
  [138] = {name = "statistics_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "busy_8states", kind = "u16", size = 2, count = 1, unit = "8 states"},
    {name = "worst_8states", kind = "u16", size = 2, count = 1, unit = "8 states"},
    {name = "missed_ticks", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "frames", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "repetitions", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "refusals", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "bad_check", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "bad_stuffing", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "too_short", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "too_long", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "line_errors", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "overruns", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "idle", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "telemetry_dropped", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [15] = {name = "self_test", fields = {
  }},
  [143] = {name = "self_test_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "done", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "failed", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "image_crc", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "start_8states", kind = "u16", size = 2, count = 1, unit = "8 states"},
  }},
  [2] = {name = "enable", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
  }},
  [130] = {name = "enable_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
  }},
  [3] = {name = "targets", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "duration_ms", kind = "u16", size = 2, count = 1, unit = "ms"},
    {name = "angle", kind = "s16", size = 2, count = 18, unit = "100 urad", mask = "mask"},
  }},
  [131] = {name = "targets_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [16] = {name = "read_targets", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
  }},
  [144] = {name = "read_targets_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "angle", kind = "s16", size = 2, count = 18, unit = "100 urad", mask = "mask"},
  }},
  [5] = {name = "state", fields = {
  }},
  [133] = {name = "state_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "supply_mv", kind = "u16", size = 2, count = 1, unit = "mV"},
    {name = "angle", kind = "s16", size = 2, count = 18, unit = "100 urad"},
  }},
  [17] = {name = "joints", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
  }},
  [145] = {name = "joints_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "angle", kind = "s16", size = 2, count = 9, unit = "100 urad", mask = "mask"},
    {name = "speed", kind = "s16", size = 2, count = 9, unit = "mrad/s", mask = "mask"},
    {name = "duty", kind = "s16", size = 2, count = 9, unit = "1/255", mask = "mask"},
    {name = "load", kind = "u8", size = 1, count = 9, unit = "1/255", mask = "mask"},
    {name = "faults", kind = "u8", size = 1, count = 9, unit = "", mask = "mask"},
  }},
  [25] = {name = "inertial", fields = {
  }},
  [153] = {name = "inertial_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "yaw_rate", kind = "u16", size = 2, count = 1, unit = "1/1024"},
    {name = "forward", kind = "u16", size = 2, count = 1, unit = "1/1024"},
    {name = "left", kind = "u16", size = 2, count = 1, unit = "1/1024"},
  }},
  [7] = {name = "stop", fields = {
  }},
  [135] = {name = "stop_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [8] = {name = "clear", fields = {
  }},
  [136] = {name = "clear_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [6] = {name = "heartbeat", fields = {
    {name = "watchdog_10ms", kind = "u8", size = 1, count = 1, unit = "10 ms"},
    {name = "reaction", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [134] = {name = "heartbeat_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [18] = {name = "telemetry", fields = {
    {name = "period_ms", kind = "u16", size = 2, count = 1, unit = "ms"},
    {name = "selection", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [146] = {name = "telemetry_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [192] = {name = "telemetry_state", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "supply_mv", kind = "u16", size = 2, count = 1, unit = "mV"},
    {name = "angle", kind = "s16", size = 2, count = 18, unit = "100 urad"},
  }},
  [193] = {name = "telemetry_commands", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "angle", kind = "s16", size = 2, count = 18, unit = "100 urad"},
  }},
  [194] = {name = "telemetry_drives", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "duty", kind = "s16", size = 2, count = 18, unit = "1/255"},
  }},
  [195] = {name = "telemetry_health", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "detail", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "supply_mv", kind = "u16", size = 2, count = 1, unit = "mV"},
    {name = "temperature_dc", kind = "s16", size = 2, count = 1, unit = "0.1 degC"},
    {name = "busy_8states", kind = "u16", size = 2, count = 1, unit = "8 states"},
    {name = "worst_8states", kind = "u16", size = 2, count = 1, unit = "8 states"},
  }},
  [4] = {name = "gains", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "kp", kind = "u16", size = 2, count = 1, unit = "1/256 /rad"},
    {name = "kd", kind = "u16", size = 2, count = 1, unit = "1/4096 s/rad"},
    {name = "dead_band", kind = "u16", size = 2, count = 1, unit = "100 urad"},
    {name = "friction", kind = "u8", size = 1, count = 1, unit = "1/255"},
  }},
  [132] = {name = "gains_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [19] = {name = "limits", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "ramp", kind = "u16", size = 2, count = 1, unit = "100 urad/ms"},
    {name = "lower", kind = "s16", size = 2, count = 1, unit = "100 urad"},
    {name = "upper", kind = "s16", size = 2, count = 1, unit = "100 urad"},
  }},
  [147] = {name = "limits_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [20] = {name = "settings", fields = {
    {name = "joint", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [148] = {name = "settings_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "joint", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "kp", kind = "u16", size = 2, count = 1, unit = "1/256 /rad"},
    {name = "kd", kind = "u16", size = 2, count = 1, unit = "1/4096 s/rad"},
    {name = "dead_band", kind = "u16", size = 2, count = 1, unit = "100 urad"},
    {name = "friction", kind = "u8", size = 1, count = 1, unit = "1/255"},
    {name = "ramp", kind = "u16", size = 2, count = 1, unit = "100 urad/ms"},
    {name = "lower", kind = "s16", size = 2, count = 1, unit = "100 urad"},
    {name = "upper", kind = "s16", size = 2, count = 1, unit = "100 urad"},
  }},
  [22] = {name = "calibration", fields = {
  }},
  [150] = {name = "calibration_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "source", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "sequence", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "erases_a", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "erases_b", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "centre", kind = "s16", size = 2, count = 18, unit = "100 urad"},
    {name = "scale", kind = "s16", size = 2, count = 18, unit = "100 urad"},
  }},
  [21] = {name = "calibrate", fields = {
    {name = "mask", kind = "u32", size = 4, count = 1, unit = ""},
    {name = "centre", kind = "s16", size = 2, count = 18, unit = "100 urad", mask = "mask"},
    {name = "scale", kind = "s16", size = 2, count = 18, unit = "100 urad", mask = "mask"},
  }},
  [149] = {name = "calibrate_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [23] = {name = "store_calibration", fields = {
  }},
  [151] = {name = "store_calibration_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "sequence", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "erases_a", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "erases_b", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [11] = {name = "unlock", fields = {
    {name = "key", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "seconds", kind = "u8", size = 1, count = 1, unit = "s"},
  }},
  [139] = {name = "unlock_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [12] = {name = "raw_drive", fields = {
    {name = "joint", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "duty", kind = "s16", size = 2, count = 1, unit = "1/255"},
    {name = "duration_ms", kind = "u16", size = 2, count = 1, unit = "ms"},
  }},
  [140] = {name = "raw_drive_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [24] = {name = "set_address", fields = {
    {name = "address", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "shared_line", kind = "u8", size = 1, count = 1, unit = ""},
  }},
  [152] = {name = "set_address_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [13] = {name = "reset", fields = {
    {name = "key", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [141] = {name = "reset_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [14] = {name = "loader", fields = {
    {name = "key", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [142] = {name = "loader_reply", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
  }},
  [255] = {name = "refused", fields = {
    {name = "tick", kind = "u32", size = 4, count = 1, unit = "ms"},
    {name = "status", kind = "u16", size = 2, count = 1, unit = ""},
    {name = "request", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "reason", kind = "u8", size = 1, count = 1, unit = ""},
    {name = "detail", kind = "u8", size = 1, count = 1, unit = ""},
  }},
}

local names = {
  CALIBRATION = {[0] = "NOMINAL", [1] = "A", [2] = "B"},
  REACTION = {[1] = "LIMP", [2] = "HOLD"},
  REFUSED = {[1] = "UNKNOWN_TYPE", [2] = "LENGTH", [3] = "RANGE", [4] = "LIMIT", [5] = "DISABLED", [6] = "FAULT", [7] = "BUSY", [8] = "ARMED", [9] = "LOCKED", [10] = "SHARED_LINE", [11] = "STORE"},
  RESET = {[0] = "POWER", [1] = "WATCHDOG", [2] = "COMMAND"},
  SHUTDOWN = {[0] = "NONE", [1] = "STOP", [2] = "LINK_LOST", [3] = "POT", [4] = "UNDERVOLTAGE", [5] = "OVERVOLTAGE", [6] = "TEMPERATURE", [7] = "REFERENCE", [8] = "STALL", [9] = "OVERLOAD", [10] = "SELF_TEST"},
  STATUS = {[1] = "ENABLED", [2] = "MOVING", [4] = "HOLDING", [8] = "UNLOCKED", [16] = "RAW_DRIVE", [32] = "TELEMETRY", [64] = "UNCALIBRATED", [128] = "MISSED_TICK"},
  of_field = {reason = "REFUSED", reset_cause = "RESET", reaction = "REACTION", source = "CALIBRATION"},
}

local kaz = Proto("kaz", "Kaz servo board")
local header = {
  address = ProtoField.uint8("kaz.address", "Address"),
  type = ProtoField.uint8("kaz.type", "Type", base.HEX),
  name = ProtoField.string("kaz.message", "Message"),
  sequence = ProtoField.uint8("kaz.sequence", "Sequence number"),
  check = ProtoField.bytes("kaz.check", "Check"),
  result = ProtoField.string("kaz.result", "Result"),
}
local makers = {u8 = ProtoField.uint8, u16 = ProtoField.uint16, s16 = ProtoField.int16,
                u32 = ProtoField.uint32}
local all = {}
for _, field in pairs(header) do all[#all + 1] = field end
for _, message in pairs(messages) do
  for _, field in ipairs(message.fields) do
    field.proto = makers[field.kind]("kaz." .. message.name .. "." .. field.name, field.name)
    all[#all + 1] = field.proto
  end
end
kaz.fields = all
local damaged = ProtoExpert.new("kaz.damaged", "Damaged frame", expert.group.CHECKSUM,
                                expert.severity.ERROR)
local wrong_length = ProtoExpert.new("kaz.length", "Wrong length for its type",
                                     expert.group.MALFORMED, expert.severity.ERROR)
kaz.experts = {damaged, wrong_length}

-- CRC-16, polynomial 0x1021, start 0xffff, over bytes[first..last].
local function crc16(bytes, first, last)
  local crc = 0xffff
  for i = first, last do
    crc = bit.bxor(crc, bit.lshift(bytes:get_index(i), 8))
    for _ = 1, 8 do
      local high = bit.band(crc, 0x8000) ~= 0
      crc = bit.band(bit.lshift(crc, 1), 0xffff)
      if high then crc = bit.bxor(crc, 0x1021) end
    end
  end
  return crc
end

-- The result as the receiver's, and of a sound frame its body.
local function receive(bytes, first, last)
  local length = last - first + 1
  if length <= 3 then return "TOO_SHORT" end
  if length > 103 then return "TOO_LONG" end
  local crc = crc16(bytes, first, last - 3)
  local check = {bit.bor(0x80, bit.rshift(crc, 14)),
                 bit.bor(0x80, bit.band(bit.rshift(crc, 7), 0x7f)),
                 bit.bor(0x80, bit.band(crc, 0x7f))}
  for i = 1, 3 do
    if bytes:get_index(last - 3 + i) ~= check[i] then return "BAD_CHECK" end
  end
  local body, at = {}, first
  while at <= last - 3 do
    local stop = at + bytes:get_index(at)
    if stop > last - 2 then return "BAD_STUFFING" end
    for i = at + 1, stop - 1 do body[#body + 1] = string.format("%02x", bytes:get_index(i)) end
    at = stop
    if at <= last - 3 then body[#body + 1] = "00" end
  end
  if #body < 3 then return "TOO_SHORT" end
  return "FRAME", ByteArray.new(table.concat(body))
end

local function number(range, kind)
  if kind == "s16" then return range:int() end
  return range:uint()
end

local function meaning(field, value)
  if field.name == "status" then
    local words, reason = {}, bit.rshift(value, 8)
    for shift = 0, 7 do
      local flag = bit.lshift(1, shift)
      if bit.band(value, flag) ~= 0 then words[#words + 1] = names.STATUS[flag] end
    end
    if reason ~= 0 then words[#words + 1] = names.SHUTDOWN[reason] or "unknown reason" end
    return table.concat(words, " ")
  end
  local group = names.of_field[field.name]
  return group and names[group][value] or field.unit
end

-- Joints of the mask, lowest first, at most `most`.
local function joints_of(mask, most)
  local joints = {}
  for joint = 0, 17 do
    if #joints < most and bit.band(mask, bit.lshift(1, joint)) ~= 0 then joints[#joints + 1] = joint end
  end
  return joints
end

local function add_fields(message, body, tree)
  local at, values = 3, {}
  for _, field in ipairs(message.fields) do
    local joints = field.mask and joints_of(values[field.mask], field.count)
    for i = 1, joints and #joints or field.count do
      if at + field.size > body:len() then return false end
      local range = body(at, field.size)
      local value = number(range, field.kind)
      local item = tree:add(field.proto, range)
      if joints then item:prepend_text("joint " .. joints[i] .. " ")
      elseif field.count > 1 then item:prepend_text("joint " .. (i - 1) .. " ") end
      local text = meaning(field, value)
      if text ~= "" then item:append_text(" (" .. text .. ")") end
      values[field.name] = value
      at = at + field.size
    end
  end
  return at == body:len()
end

function kaz.dissector(buffer, packet, root)
  packet.cols.protocol = "Kaz"
  local bytes = buffer:bytes()
  local first, last = 0, bytes:len() - 1
  while first <= last and bytes:get_index(first) == 0 do first = first + 1 end
  while last >= first and bytes:get_index(last) == 0 do last = last - 1 end
  local tree = root:add(kaz, buffer())
  local result, body = receive(bytes, first, last)
  tree:add(header.result, result):set_generated()
  packet.cols.info = result
  if result ~= "FRAME" then
    tree:add_proto_expert_info(damaged, result)
    return
  end
  local view = body:tvb("Body")
  local code, sequence = view(1, 1):uint(), view(2, 1):uint()
  local message = messages[code]
  local name = message and message.name or string.format("unknown type 0x%02x", code)
  tree:append_text(": " .. name)
  packet.cols.info = string.format("%s, board %d, number %d", name, view(0, 1):uint(), sequence)
  packet.cols.src = code >= 0x80 and "board" or "host"
  packet.cols.dst = code >= 0x80 and "host" or "board"
  tree:add(header.address, view(0, 1))
  tree:add(header.type, view(1, 1))
  tree:add(header.name, name):set_generated()
  tree:add(header.sequence, view(2, 1))
  if message and not add_fields(message, view, tree) then tree:add_proto_expert_info(wrong_length) end
  tree:add(header.check, buffer(last - 2, 3))
end

DissectorTable.get("wtap_encap"):add((wtap or wtap_encaps).USER0, kaz)
