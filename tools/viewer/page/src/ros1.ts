// Decodes the messages that the page shows: ROS 1 encoding, fields in order, little-endian, no padding.
// SPDX-License-Identifier: Apache-2.0
//
// By hand for a dozen schemas: readers that generate code need 'unsafe-eval'.

export type Vector = [number, number, number];
export interface Pose { position: Vector; turn: [number, number, number, number] }
export interface Header { sequence: number; seconds: number; frame: string }

const utf8 = new TextDecoder();

export class Reader {
  private at = 0;
  constructor(private readonly view: DataView) {}
  u8(): number { return this.view.getUint8(this.step(1)); }
  u16(): number { return this.view.getUint16(this.step(2), true); }
  u32(): number { return this.view.getUint32(this.step(4), true); }
  i32(): number { return this.view.getInt32(this.step(4), true); }
  f32(): number { return this.view.getFloat32(this.step(4), true); }
  f64(): number { return this.view.getFloat64(this.step(8), true); }
  f64s(count: number): number[] { return Array.from({ length: count }, () => this.f64()); }
  bytes(): Uint8Array {
    const size = this.u32();
    const from = this.step(size);
    return new Uint8Array(this.view.buffer, this.view.byteOffset + from, size);
  }
  text(): string { return utf8.decode(this.bytes()); }
  list<T>(read: () => T): T[] {
    const count = this.u32();
    if (count > this.view.byteLength) throw new RangeError("a list is longer than its message");
    return Array.from({ length: count }, read);
  }
  header(): Header {
    const sequence = this.u32();
    const seconds = this.u32() + this.u32() * 1e-9;
    return { sequence, seconds, frame: this.text() };
  }
  vector(): Vector { return [this.f64(), this.f64(), this.f64()]; }
  pose(): Pose {
    return { position: this.vector(), turn: [this.f64(), this.f64(), this.f64(), this.f64()] };
  }
  private step(size: number): number {
    const from = this.at;
    this.at += size;
    return from;
  }
}

export interface Transform extends Pose { child: string }
export function readTransforms(r: Reader): Transform[] {
  return r.list(() => {
    r.header();
    const child = r.text();
    return { child, ...r.pose() };
  });
}

export interface Marker {
  frame: string; space: string; id: number; type: number; action: number; pose: Pose; scale: Vector;
  color: [number, number, number, number]; texture: string;
}
export function readMarkers(r: Reader): Marker[] {
  const color = (): [number, number, number, number] => [r.f32(), r.f32(), r.f32(), r.f32()];
  return r.list(() => {
    const marker: Marker = {
      frame: r.header().frame, space: r.text(), id: r.i32(), type: r.i32(), action: r.i32(), pose: r.pose(),
      scale: r.vector(), color: color(), texture: "",
    };
    r.u32(); r.u32();  // lifetime
    r.u8();
    r.list(() => r.vector());
    r.list(color);
    marker.texture = r.text();
    r.text(); r.u8();
    return marker;
  });
}

export interface BoardState {
  seconds: number; names: string[]; target: number[]; measured: number[]; duty: number[]; status: number;
  shutdown: string; supply: number; worstTick: number; toBoard: number; toHost: number; damaged: number;
}
export function readBoard(r: Reader): BoardState {
  const seconds = r.header().seconds;
  const names = Array.from({ length: 18 }, () => r.text());
  return {
    seconds, names, target: r.f64s(18), measured: r.f64s(18), duty: r.f64s(18), status: r.u16(),
    shutdown: r.text(), supply: r.f64(), worstTick: r.f64(), toBoard: r.u32(), toHost: r.u32(), damaged: r.u32(),
  };
}

// Torques of the motors, N m; none of a robot at a port.
export interface Torques { seconds: number; effort: number[] }
export function readJointStates(r: Reader): Torques {
  const seconds = r.header().seconds;
  r.list(() => r.text());
  r.list(() => r.f64());
  r.list(() => r.f64());
  return { seconds, effort: r.list(() => r.f64()) };
}

export interface Picture { header: Header; format: string; data: Uint8Array }
export function readPicture(r: Reader): Picture {
  return { header: r.header(), format: r.text(), data: r.bytes() };
}

export interface Intrinsics { width: number; height: number; fx: number; fy: number; cx: number; cy: number }
export function readCameraInfo(r: Reader): Intrinsics {
  r.header();
  const height = r.u32(), width = r.u32();
  r.text();
  r.list(() => r.f64());
  const k = r.f64s(9);
  return { width, height, fx: k[0] ?? 1, cx: k[2] ?? 0, fy: k[4] ?? 1, cy: k[5] ?? 0 };
}

// Circles of foxglove_msgs/ImageAnnotations, px of the picture.
export interface Circle { x: number; y: number; diameter: number }
export function readCircles(r: Reader): Circle[] {
  return r.list(() => {
    r.u32(); r.u32();
    const circle = { x: r.f64(), y: r.f64(), diameter: r.f64() };
    r.f64();
    r.f64s(8);
    return circle;
  });
}

export interface Grid {
  resolution: number; width: number; height: number; origin: Pose; cells: Int8Array;
}
export function readGrid(r: Reader): Grid {
  r.header();
  r.u32(); r.u32();
  const resolution = r.f32();
  const width = r.u32(), height = r.u32();
  const origin = r.pose();
  const cells = new Int8Array(r.bytes());
  return { resolution, width, height, origin, cells };
}
export function readPath(r: Reader): Pose[] {
  r.header();
  return r.list(() => { r.header(); return r.pose(); });
}
export function readPoseStamped(r: Reader): Pose { r.header(); return r.pose(); }
