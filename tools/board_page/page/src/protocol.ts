// The message table as data: codes fields, decodes them, and says what they mean.
// SPDX-License-Identifier: Apache-2.0
import table from "./protocol.json";
import { bytesOf } from "./chip";

export interface Field {
  name: string; type: string; unit: string; kind: string; count: number; low: number; high: number; bounded: boolean;
  mask?: string; text: string;
}
export interface Message {
  name: string; code: number; request: boolean; reply: string | null; kind: string; text: string; fields: Field[];
}
export interface Joint { name: string; lower: number; upper: number; pwm: number; port: number; bit: number; sign: number }
export type Values = Record<string, number | number[]>;

export const messages = table.messages as Message[];
export const joints = table.joints as Joint[];
export const constants = table.constants as Record<string, Record<string, number>>;
const byCode = new Map(messages.map((message) => [message.code, message]));
export const messageOf = (code: number) => byCode.get(code);

const SIZES: Record<string, number> = { u8: 1, u16: 2, s16: 2, u32: 4 };
const sizeOf = (type: string) => SIZES[type] ?? 0;

// Joints of a mask, lowest first, as many as the message takes.
export const jointsOf = (mask: number, most = joints.length) =>
  joints.map((_, joint) => joint).filter((joint) => mask & 1 << joint).slice(0, most);

// The numbers of a field that a body has: of a masked one, as many as its mask says.
function countOf(field: Field, values: Values): number {
  if (field.kind === "one") return 1;
  return field.mask === undefined ? field.count : jointsOf(Number(values[field.mask] ?? 0), field.count).length;
}

export function pack(message: Message, values: Values): Uint8Array {
  const bytes: number[] = [];
  for (const field of message.fields) {
    const given = values[field.name] ?? 0;
    const numbers = Array.isArray(given) ? given : [given];
    for (let i = 0; i < countOf(field, values); ++i)
      for (let shift = 8 * (sizeOf(field.type) - 1); shift >= 0; shift -= 8) bytes.push((numbers[i] ?? 0) >> shift & 255);
  }
  return Uint8Array.from(bytes);
}

// Null: not as long as the message.
export function unpack(message: Message, fields: Uint8Array): Values | null {
  const values: Values = {};
  const view = new DataView(fields.buffer, fields.byteOffset, fields.length);
  let at = 0;
  for (const field of message.fields) {
    const size = sizeOf(field.type), count = countOf(field, values);
    if (at + size * count > fields.length) return null;
    const numbers = Array.from({ length: count }, (_, i) => {
      const place = at + size * i;
      return field.type === "s16" ? view.getInt16(place) : size === 1 ? view.getUint8(place)
        : size === 2 ? view.getUint16(place) : view.getUint32(place);
    });
    at += size * count;
    values[field.name] = field.kind === "one" ? numbers[0] ?? 0 : numbers;
  }
  return at === fields.length ? values : null;
}

const nameOf = (group: string, value: number) =>
  Object.entries(constants[group] ?? {}).find(([, number]) => number === value)?.[0] ?? String(value);
export const flagsOf = (group: string, value: number) =>
  Object.entries(constants[group] ?? {}).filter(([, bit]) => bit && value & bit).map(([name]) => name.toLowerCase().replaceAll("_", " "));
export const reasonOf = (shutdown: number) => nameOf("SHUTDOWN", shutdown).toLowerCase().replaceAll("_", " ");

// In words, where a number stands for some; the field's text names the group.
function meaning(field: Field, value: number): string {
  const group = /KZ_([A-Z]+)_\*/.exec(field.text)?.[1];
  if (field.name === "status") {
    const reason = value >> 8;
    return [...flagsOf("STATUS", value & 255), ...(reason ? [`shutdown: ${reasonOf(reason)}`] : [])].join(", ") || "none";
  }
  if (field.name.endsWith("mask")) return jointsOf(value).map((joint) => joints[joint]?.name).join(" ") || "none";
  if (group !== undefined && group in constants)
    return /flags|which|tests/.test(field.text) ? flagsOf(group, value).join(", ") || "none" : nameOf(group, value).toLowerCase();
  if (field.name === "reason" && "REFUSED" in constants) return nameOf("REFUSED", value).toLowerCase().replaceAll("_", " ");
  if (field.unit === "100 urad") return `${(value * 0.0180 / Math.PI).toFixed(2)}°`;
  if (field.unit === "mV") return `${(value / 1000).toFixed(2)} V`;
  if (field.unit === "0.1 degC") return `${(value / 10).toFixed(1)} °C`;
  if (field.unit === "10 ms") return `${10 * value} ms`;
  return "";
}

// One field as text: numbers with unit and meaning; of several joints by name.
export function shown(field: Field, value: number | number[], values: Values): string {
  const unit = field.unit === "" || /^\d/.test(field.unit) === false ? field.unit : `× ${field.unit}`;
  const one = (number: number) => {
    const means = meaning(field, number);
    return `${number}${unit ? ` ${unit}` : ""}${means ? ` (${means})` : ""}`;
  };
  if (!Array.isArray(value)) return one(value);
  const which = field.mask === undefined ? value.map((_, i) => i) : jointsOf(Number(values[field.mask]), field.count);
  return value.map((number, i) => `${value.length === joints.length || field.mask ? joints[which[i] ?? 0]?.name : i}: ${one(number)}`).join("; ");
}

export const angleText = (urad100: number) => `${(urad100 * 0.018 / Math.PI).toFixed(1).replace(/^-(?=0\.0$)/, "")}°`;

// KZ_RECEIVE_* of shared/protocol/frame.h.
export const RESULTS = ["not complete", "valid", "wrong check", "impossible stuffing", "too short", "too long", "line error",
  "overrun", "given up: silence"];

export interface Decoded { address: number; code: number; sequence: number; message?: Message; values: Values | null }
export function decode(body: string): Decoded {
  const bytes = bytesOf(body);
  const message = messageOf(bytes[1] ?? 0);
  return {
    address: bytes[0] ?? 0, code: bytes[1] ?? 0, sequence: bytes[2] ?? 0, message,
    values: message ? unpack(message, bytes.subarray(3)) : null,
  };
}

// The CRC that a frame carries in its last three bytes but one; null where it has none.
export function checkOf(wire: string): number | null {
  const bytes = bytesOf(wire);
  const [a, b, c] = bytes.subarray(-4, -1);
  if (bytes.length < 6 || a === undefined || b === undefined || c === undefined || (a & b & c & 128) === 0) return null;
  return (a & 3) << 14 | (b & 127) << 7 | c & 127;
}
