// The last seconds of some joints: target, potentiometer, duty; torque.
// SPDX-License-Identifier: Apache-2.0
import type { BoardState, Torques } from "./ros1";

const SECONDS = 10;
// Of the joints where there are several: Okabe and Ito, for all kinds of sight.
export const JOINT_COLORS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9"];

// What is drawn of a board's state.
export type JointStates = Pick<BoardState, "seconds" | "names" | "target" | "measured" | "duty">;

// What came in the last seconds.
class History<T extends { seconds: number }> {
  joints = [0];
  protected states: T[] = [];

  constructor(protected readonly canvas: HTMLCanvasElement) {}

  add(state: T): void {
    const newest = this.states.at(-1);
    if (newest && state.seconds <= newest.seconds) this.states = [];  // of another run, or a jump back
    this.states.push(state);
    while ((this.states[0]?.seconds ?? 0) < state.seconds - SECONDS) this.states.shift();
  }

  // An empty canvas with the page's font and colors; undefined while it is hidden.
  protected sheet(): { context: CanvasRenderingContext2D; color: (name: string) => string } | undefined {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const context = this.canvas.getContext("2d");
    if (!context || width === 0) return undefined;
    this.canvas.width = width * devicePixelRatio;
    this.canvas.height = height * devicePixelRatio;
    context.scale(devicePixelRatio, devicePixelRatio);
    const style = getComputedStyle(document.documentElement);
    const color = (name: string) => style.getPropertyValue(name);
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = color("--faint");
    context.strokeStyle = color("--line");
    return { context, color };
  }

  // `y` of each state over time, from `left` to `right`, px.
  protected curve(context: CanvasRenderingContext2D, left: number, right: number, y: (state: T) => number,
    color: string, dash: number[] = []): void {
    const newest = this.states.at(-1)?.seconds ?? 0;
    context.strokeStyle = color;
    context.lineWidth = 1.6;
    context.setLineDash(dash);
    context.beginPath();
    for (const state of this.states) context.lineTo(right - (newest - state.seconds) / SECONDS * (right - left), y(state));
    context.stroke();
    context.setLineDash([]);
  }

  // One joint has a color for each quantity, several have a color each.
  protected colorOf(index: number, alone: string): string {
    return this.joints.length === 1 ? alone : JOINT_COLORS[index] ?? alone;
  }
}

export class Plot extends History<JointStates> {
  count(): number { return this.states.length; }
  target(joint: string): number | undefined {
    const newest = this.states.at(-1);
    return newest?.target[newest.names.indexOf(joint)];
  }

  draw(): void {
    const sheet = this.sheet();
    if (!sheet) return;
    const { context, color } = sheet;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const degrees = (rad: number | undefined) => (rad ?? 0) * 180 / Math.PI;
    const angles = this.states.flatMap((s) => this.joints.flatMap((j) => [degrees(s.target[j]), degrees(s.measured[j])]));
    const low = Math.min(-5, ...angles), high = Math.max(5, ...angles);
    const left = 42, right = width - 30, top = 8, bottom = height - 18;
    const y = (value: number) => bottom - (value - low) / (high - low) * (bottom - top);
    const yDuty = (value: number) => bottom - (value + 1) / 2 * (bottom - top);
    context.textAlign = "right";
    for (const value of [low, 0, high]) {
      context.beginPath(); context.moveTo(left, y(value)); context.lineTo(right, y(value)); context.stroke();
      context.fillText(`${value.toFixed(0)}°`, left - 5, y(value) + 4);
    }
    context.textAlign = "left";
    context.fillText("1", right + 5, top + 6); context.fillText("−1", right + 5, bottom + 4);
    context.fillText(`last ${SECONDS} s`, left, height - 4);
    this.joints.forEach((j, i) => {
      this.curve(context, left, right, (s) => yDuty(s.duty[j] ?? 0), this.colorOf(i, color("--duty")), [1, 3]);
      this.curve(context, left, right, (s) => y(degrees(s.measured[j])), this.colorOf(i, color("--measured")));
      this.curve(context, left, right, (s) => y(degrees(s.target[j])), this.colorOf(i, color("--target")), [5, 3]);
    });
  }
}

// Below it: the motors' torques, where they are known.
export class TorquePlot extends History<Torques> {
  override add(state: Torques): void {
    super.add(state);
    const known = state.effort.length > 0;
    this.canvas.hidden = !known;
    (document.getElementById("torque-legend") as HTMLElement).hidden = !known;
  }

  draw(): void {
    if (this.states.length === 0) return;
    const sheet = this.sheet();
    if (!sheet) return;
    const { context, color } = sheet;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const torque = (state: Torques, joint: number) => state.effort[joint] ?? 0;
    const most = Math.max(0.1, ...this.states.flatMap((s) => this.joints.map((j) => Math.abs(torque(s, j)))));
    const left = 42, right = width - 30, top = 6, bottom = height - 6;
    const y = (value: number) => bottom - (value + most) / (2 * most) * (bottom - top);
    context.textAlign = "right";
    for (const value of [-most, 0, most]) {
      context.beginPath(); context.moveTo(left, y(value)); context.lineTo(right, y(value)); context.stroke();
      context.fillText(value.toFixed(value === 0 ? 0 : 2), left - 5, y(value) + 4);
    }
    context.textAlign = "left";
    context.fillText("N m", right + 3, y(0) + 4);
    this.joints.forEach((j, i) =>
      this.curve(context, left, right, (s) => y(torque(s, j)), this.colorOf(i, color("--measured"))));
  }
}
