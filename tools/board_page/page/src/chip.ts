// The emulated board, compiled by emscripten: tools/board_page/wasm/api.cpp as typed functions.
// SPDX-License-Identifier: Apache-2.0
import create from "./board.js";

export interface Joint {
  angle: number; speed: number; torque: number; current: number; winding: number;  // of the shaft and its motor
  duty: number; hand: number | null; code: number;
  target: number; command: number; measured: number; on: boolean; flags: number;  // of the firmware, 100 urad
}
export interface Servo {
  tick: number; status: number; enabled: number; silent_ms: number; watchdog_ms: number; shutdown: number; detail: number;
  shutdown_tick: number; reset_cause: number; supply_mv: number; temperature_dc: number; tests_failed: number;
}
export interface View {
  states: number; power: boolean; chip_states: number; instructions: number; pc: number; ccr: number; asleep: boolean;
  symbol: string; next: string; er: number[]; ports: Record<string, number>; pw: number[]; tmo: number[]; drivers: boolean;
  supply_volts: number; supply_amperes: number; driver_celsius: number; servo?: Servo; joints: Joint[];
  registers?: [unit: string, name: string, address: number, size: number, value: number][];
}
export interface Entry { out: boolean; at: number; wire: string; result: number; body: string }

export const bytesOf = (hex: string) => Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));

export class Chip {
  private constructor(private readonly module: Awaited<ReturnType<typeof create>>) {}

  static async load(): Promise<Chip> {
    return new Chip(await create());
  }
  private text(name: string, types: string[] = [], words: unknown[] = []): string {
    return this.module.ccall(`board_${name}`, "string", types, words) as string;
  }
  private call(name: string, types: string[] = [], words: unknown[] = []): void {
    this.module.ccall(`board_${name}`, null, types, words);
  }
  // Empty, or an error.
  begin(noise: boolean): string { return this.text("begin", ["number"], [noise ? 1 : 0]); }
  run(milliseconds: number): string { return this.text("run", ["number"], [milliseconds]); }
  view(registers: boolean): View { return JSON.parse(this.text("view", ["number"], [registers ? 1 : 0])) as View; }
  line(): Entry[] { return JSON.parse(this.text("line")) as Entry[]; }
  send(address: number, type: number, fields: Uint8Array): number {
    return this.module.ccall("board_send", "number", ["number", "number", "array", "number"],
      [address, type, fields, fields.length]) as number;
  }
  preview(address: number, type: number, fields: Uint8Array): string {
    return this.text("preview", ["number", "number", "array", "number"], [address, type, fields, fields.length]);
  }
  raw(bytes: Uint8Array): void { this.call("raw", ["array", "number"], [bytes, bytes.length]); }
  keepAlive(ms: number): void { this.call("keep_alive", ["number"], [ms]); }
  turn(joint: number, rad: number): void { this.call("turn", ["number", "number"], [joint, rad]); }
  release(joint: number): void { this.call("release", ["number"], [joint]); }
  potOpen(joint: number, open: boolean): void { this.call("pot_open", ["number", "number"], [joint, open ? 1 : 0]); }
  supply(volts: number): void { this.call("supply", ["number"], [volts]); }
  power(on: boolean): void { this.call("power", ["number"], [on ? 1 : 0]); }
  reset(): void { this.call("reset"); }
  script(commands: string, noise: boolean): string {
    return this.text("script", ["string", "number"], [commands, noise ? 1 : 0]);
  }
}
