// The table of joints: what the firmware has and wants, what drives the pins, and a hand at each shaft.
// SPDX-License-Identifier: Apache-2.0
import type { Chip, View } from "./chip";
import { element, put } from "./dom";
import { angleText, flagsOf, joints } from "./protocol";

interface Row { row: HTMLTableRowElement; cells: HTMLTableCellElement[]; bar: HTMLElement; slider: HTMLInputElement; free: HTMLButtonElement }
const degrees = (rad: number) => rad * 180 / Math.PI;
const radians = (deg: number) => deg * Math.PI / 180;

export class Joints {
  private readonly rows: Row[];

  constructor(private readonly chip: () => Chip, changed: () => void) {
    const body = element("joints").querySelector("tbody");
    if (!body) throw new Error("index.html has no table of joints");
    this.rows = joints.map(({ name, lower, upper }, joint) => {
      const row = body.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = name;
      row.append(head);
      const cells = Array.from({ length: 7 }, () => row.insertCell());
      const bar = document.createElement("span");
      bar.className = "bar";
      const slider = document.createElement("input"), free = document.createElement("button");
      Object.assign(slider, { type: "range", min: (lower * 0.018 / Math.PI).toFixed(1), max: (upper * 0.018 / Math.PI).toFixed(1),
        step: "0.5", id: `hand-${name}` });
      slider.setAttribute("aria-label", `turn ${name} by hand, degrees`);
      free.type = "button";
      free.textContent = "let go";
      free.setAttribute("aria-label", `let go of ${name}`);
      slider.oninput = () => { this.chip().turn(joint, radians(Number(slider.value))); changed(); };
      free.onclick = () => { this.chip().release(joint); changed(); };
      cells[6]?.append(slider, free);
      return { row, cells, bar, slider, free };
    });
  }

  show(view: View): void {
    for (const [i, { cells, bar, slider, free, row }] of this.rows.entries()) {
      const joint = view.joints[i], wire = joints[i];
      if (!joint || !wire) continue;
      const pin = (view.ports[`P${wire.port}`] ?? 0) >> wire.bit & 1;
      const counts = wire.pwm < 16 ? view.pw[wire.pwm] : view.tmo[wire.pwm - 16];
      const known = view.servo !== undefined && view.power;
      put(cells[0], known ? angleText(joint.target) : "–");
      put(cells[1], known ? angleText(joint.measured) : "–");
      put(cells[2], known ? String(joint.code) : "–");
      const duty = view.drivers ? joint.duty : 0;
      if (!bar.isConnected) cells[3]?.append(bar, " ");
      put(cells[3]?.lastChild, ` ${Math.round(100 * duty)} %`);
      bar.style.setProperty("--duty-of", String(duty));
      cells[3]?.setAttribute("title", `${wire.pwm < 16 ? `PW${wire.pwm}` : `TMO${wire.pwm - 16}`}: ${counts} of 256 high`);
      put(cells[4], `P${wire.port}${wire.bit} ${pin ? "high" : "low"}`);
      put(cells[5], known ? flagsOf("JOINT", joint.flags).join(", ") || "off" : "no power");
      row.classList.toggle("on", known && joint.on);
      free.disabled = joint.hand === null;
      if (joint.hand === null && document.activeElement !== slider) slider.value = degrees(joint.angle).toFixed(1);
      slider.title = `${degrees(joint.angle).toFixed(1)}°`;
    }
  }
}
