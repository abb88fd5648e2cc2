// The form that a message is filled in with, its bytes before they go out, and any bytes by hand.
// SPDX-License-Identifier: Apache-2.0
import { bytesOf, type Chip } from "./chip";
import { element } from "./dom";
import { angleText, checkOf, type Field, joints, jointsOf, type Message, messages, pack, type Values } from "./protocol";

const RANGES: Record<string, [number, number]> = {
  u8: [0, 0xff], u16: [0, 0xffff], s16: [-0x8000, 0x7fff], u32: [0, 0xffffffff],
};
const spaced = (hex: string) => hex.replace(/..(?=.)/g, "$& ");

export class MessageForm {
  private message: Message;
  private values: Values = {};
  private readonly fields = element("fields", HTMLDivElement);
  private readonly address = element("address", HTMLInputElement);

  constructor(private readonly chip: () => Chip, private readonly sent: () => void) {
    const select = element("message", HTMLSelectElement);
    const requests = messages.filter((message) => message.request);
    for (const [i, message] of requests.entries())
      select.add(new Option(`${message.name} (0x${message.code.toString(16).padStart(2, "0")})`, String(i)));
    const first = requests.find(({ name }) => name === "enable") ?? requests[0];
    if (!first) throw new Error("the message table is empty");
    this.message = first;
    select.value = String(requests.indexOf(first));
    select.onchange = () => { this.message = requests[Number(select.value)] ?? first; this.choose(); };
    this.address.oninput = () => this.preview();
    element("form", HTMLFormElement).onsubmit = (event) => {
      event.preventDefault();
      this.chip().send(Number(this.address.value), this.message.code, pack(this.message, this.values));
      this.preview();
      this.sent();
    };
    const raw = element("raw", HTMLInputElement), note = element("raw-note", HTMLParagraphElement);
    element("raw-form", HTMLFormElement).onsubmit = (event) => {
      event.preventDefault();
      const text = raw.value.replace(/0x|[\s,]/gi, "");
      const valid = /^([0-9a-f]{2})+$/i.test(text);
      note.textContent = valid ? "" : "give pairs of hex digits, such as 00 04 01 01";
      if (!valid) return;
      this.chip().raw(bytesOf(text));
      this.sent();
    };
    element("raw-copy", HTMLButtonElement).onclick = () => { raw.value = element("preview").textContent ?? ""; note.textContent = ""; };
    this.choose();
  }

  private choose(): void {
    this.values = {};
    for (const field of this.message.fields)
      this.values[field.name] = field.kind === "one" ? Math.min(Math.max(field.name === "mask" ? 1 : 0, field.low), field.high)
        : Array<number>(joints.length).fill(0);
    element("about").textContent = this.message.text;
    this.draw();
  }

  // The numbers of a field in the order of the wire: of a masked one, those of its mask's joints.
  private numbers(field: Field): { label: string; index: number }[] {
    if (field.kind === "one") return [{ label: field.name, index: -1 }];
    const which = field.mask === undefined ? joints.map((_, i) => i) : jointsOf(Number(this.values[field.mask]), field.count);
    return which.slice(0, field.count).map((joint, index) => ({ label: `${field.name} of ${joints[joint]?.name}`, index }));
  }

  private draw(): void {
    this.fields.replaceChildren();
    for (const field of this.message.fields) {
      for (const { label, index } of this.numbers(field)) this.fields.append(this.numberRow(field, label, index));
      if (field.name === "mask") this.fields.append(this.maskRow(field));
      const note = document.createElement("p");
      note.textContent = `${field.bounded ? `${field.low} to ${field.high}; ` : ""}${field.text}`;
      this.fields.append(note);
    }
    this.preview();
  }

  private numberRow(field: Field, label: string, index: number): HTMLElement {
    const row = document.createElement("label"), input = document.createElement("input"), means = document.createElement("span");
    row.className = "field";
    const [low, high] = RANGES[field.type] ?? [0, 0];
    Object.assign(input, { type: "number", min: String(low), max: String(high), step: "1" });
    input.name = index < 0 ? field.name : `${field.name}.${index}`;
    const value = this.values[field.name];
    input.value = String(Array.isArray(value) ? value[index] ?? 0 : value);
    const show = () => {
      means.textContent = `${field.unit}${field.unit === "100 urad" ? ` = ${angleText(Number(input.value))}` : ""}`;
    };
    input.oninput = () => {
      const number = Math.min(high, Math.max(low, Math.round(Number(input.value) || 0)));
      if (Array.isArray(value)) value[index] = number; else this.values[field.name] = number;
      show();
      if (field.name === "mask") this.drawKeeping(input.name); else this.preview();
    };
    show();
    row.append(label, " ", input, " ", means);
    return row;
  }

  private maskRow(field: Field): HTMLElement {
    const row = document.createElement("fieldset"), legend = document.createElement("legend");
    legend.textContent = "joints";
    row.append(legend);
    for (const [joint, { name }] of joints.entries()) {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.name = `joint.${joint}`;
      box.checked = (Number(this.values[field.name]) & 1 << joint) !== 0;
      box.onchange = () => {
        this.values[field.name] = (Number(this.values[field.name]) ^ 1 << joint) >>> 0;
        this.drawKeeping(box.name);
      };
      label.append(box, ` ${name}`);
      row.append(label);
    }
    return row;
  }

  // Draws again, and the keyboard stays where it was.
  private drawKeeping(name: string): void {
    this.draw();
    this.fields.querySelector<HTMLInputElement>(`[name="${name}"]`)?.focus();
  }

  preview(): void {
    const wire = this.chip().preview(Number(this.address.value), this.message.code, pack(this.message, this.values));
    const crc = checkOf(wire);
    element("preview").textContent = spaced(wire);
    element("check").textContent = `${wire.length / 2} bytes, ${(wire.length * 5 / 115.2).toFixed(2)} ms on the line; CRC-16 `
      + `0x${(crc ?? 0).toString(16).padStart(4, "0")} in the last three bytes before the zero`;
  }
}
