// Which joints the plot shows: checkboxes in a list that unfolds.
// SPDX-License-Identifier: Apache-2.0
import { JOINT_COLORS } from "./plot";

function element(id: string): HTMLElement { return document.getElementById(id) as HTMLElement; }

export class Joints {
  private names: string[] = [];

  // `onChange` gets the numbers of the joints, in the robot's order; at least one, at most JOINT_COLORS.
  constructor(private readonly onChange: (joints: number[]) => void) {}

  // The robot's joints by number; empty names are skipped. `first` is chosen. Does nothing if they are known.
  offer(names: string[], first: string): void {
    if (this.names.join() === names.join()) return;
    this.names = names;
    element("joint-list").replaceChildren(...names.flatMap((name, joint) => {
      if (name === "") return [];
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.value = String(joint);
      box.checked = name === first;
      box.onchange = () => this.choose();
      label.append(box, ` ${name}`);
      return [label];
    }));
    if (this.chosen().length === 0) for (const box of this.boxes().slice(0, 1)) box.checked = true;
    this.choose();
  }

  private boxes(): HTMLInputElement[] { return [...element("joint-list").querySelectorAll("input")]; }
  private chosen(): number[] { return this.boxes().filter((box) => box.checked).map((box) => Number(box.value)); }

  // The last one stays, and no more are taken than there are colors.
  private choose(): void {
    const joints = this.chosen();
    for (const box of this.boxes())
      box.disabled = box.checked ? joints.length === 1 : joints.length >= JOINT_COLORS.length;
    element("joints-chosen").replaceChildren(...joints.map((joint, i) => {
      const name = document.createElement("span");
      name.textContent = this.names[joint] ?? "";
      if (joints.length > 1) name.style.borderBottomColor = JOINT_COLORS[i] ?? "";
      return name;
    }));
    element("joints").parentElement?.classList.toggle("several", joints.length > 1);
    this.onChange(joints);
  }
}
