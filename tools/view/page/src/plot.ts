// A joint's last seconds: target, potentiometer, duty; torque.
// SPDX-License-Identifier: Apache-2.0
import type { BoardState, Torques } from "./ros1";

const SECONDS = 10;

// What is drawn of a board's state.
export type JointStates = Pick<BoardState, "seconds" | "names" | "target" | "measured" | "duty">;

// What came in the last seconds.
class History<T extends { seconds: number }> {
  joint = 0;
  protected states: T[] = [];

  constructor(protected readonly canvas: HTMLCanvasElement) {}

  add(state: T): void {
    const newest = this.states.at(-1);
    if (newest && state.seconds <= newest.seconds) this.states = [];  // of another run, or a jump back
    this.states.push(state);
    while ((this.states[0]?.seconds ?? 0) < state.seconds - SECONDS) this.states.shift();
  }
}

export class Plot extends History<JointStates> {
  count(): number { return this.states.length; }
  target(joint: string): number | undefined {
    const newest = this.states.at(-1);
    return newest?.target[newest.names.indexOf(joint)];
  }

  draw(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const context = this.canvas.getContext("2d");
    const newest = this.states.at(-1);
    if (!context || width === 0) return;
    const scale = devicePixelRatio;
    this.canvas.width = width * scale;
    this.canvas.height = height * scale;
    context.scale(scale, scale);
    const style = getComputedStyle(document.documentElement);
    const color = (name: string) => style.getPropertyValue(name);
    const degrees = (rad: number) => rad * 180 / Math.PI;
    const angles = this.states.flatMap((s) => [degrees(s.target[this.joint] ?? 0), degrees(s.measured[this.joint] ?? 0)]);
    const low = Math.min(-5, ...angles), high = Math.max(5, ...angles);
    const left = 42, right = width - 30, top = 8, bottom = height - 18;
    const x = (s: number) => right - ((newest?.seconds ?? 0) - s) / SECONDS * (right - left);
    const y = (value: number) => bottom - (value - low) / (high - low) * (bottom - top);
    const yDuty = (value: number) => bottom - (value + 1) / 2 * (bottom - top);
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = color("--faint");
    context.strokeStyle = color("--line");
    context.textAlign = "right";
    for (const value of [low, 0, high]) {
      context.beginPath(); context.moveTo(left, y(value)); context.lineTo(right, y(value)); context.stroke();
      context.fillText(`${value.toFixed(0)}°`, left - 5, y(value) + 4);
    }
    context.textAlign = "left";
    context.fillText("1", right + 5, top + 6); context.fillText("−1", right + 5, bottom + 4);
    context.fillText(`last ${SECONDS} s`, left, height - 4);
    const line = (read: (s: JointStates) => number, name: string, dash: number[]) => {
      context.strokeStyle = color(name);
      context.lineWidth = 1.6;
      context.setLineDash(dash);
      context.beginPath();
      this.states.forEach((s, i) => { i === 0 ? context.moveTo(x(s.seconds), read(s)) : context.lineTo(x(s.seconds), read(s)); });
      context.stroke();
      context.setLineDash([]);
    };
    line((s) => yDuty(s.duty[this.joint] ?? 0), "--duty", [1, 3]);
    line((s) => y(degrees(s.measured[this.joint] ?? 0)), "--measured", []);
    line((s) => y(degrees(s.target[this.joint] ?? 0)), "--target", [5, 3]);
  }
}

// Below it: the motor's torque, where it is known.
export class TorquePlot extends History<Torques> {
  override add(state: Torques): void {
    super.add(state);
    const known = state.effort.length > 0;
    this.canvas.hidden = !known;
    (document.getElementById("torque-legend") as HTMLElement).hidden = !known;
  }

  draw(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const context = this.canvas.getContext("2d");
    const newest = this.states.at(-1);
    if (!context || width === 0 || !newest) return;
    const scale = devicePixelRatio;
    this.canvas.width = width * scale;
    this.canvas.height = height * scale;
    context.scale(scale, scale);
    const style = getComputedStyle(document.documentElement);
    const values = this.states.map(({ effort }) => effort[this.joint] ?? 0);
    const most = Math.max(0.1, ...values.map(Math.abs));
    const left = 42, right = width - 30, top = 6, bottom = height - 6;
    const x = (s: number) => right - (newest.seconds - s) / SECONDS * (right - left);
    const y = (value: number) => bottom - (value + most) / (2 * most) * (bottom - top);
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = style.getPropertyValue("--faint");
    context.strokeStyle = style.getPropertyValue("--line");
    context.textAlign = "right";
    for (const value of [-most, 0, most]) {
      context.beginPath(); context.moveTo(left, y(value)); context.lineTo(right, y(value)); context.stroke();
      context.fillText(value.toFixed(value === 0 ? 0 : 2), left - 5, y(value) + 4);
    }
    context.textAlign = "left";
    context.fillText("N m", right + 3, y(0) + 4);
    context.strokeStyle = style.getPropertyValue("--measured");
    context.lineWidth = 1.6;
    context.beginPath();
    this.states.forEach((s, i) => { i === 0 ? context.moveTo(x(s.seconds), y(values[i] ?? 0)) : context.lineTo(x(s.seconds), y(values[i] ?? 0)); });
    context.stroke();
  }
}
