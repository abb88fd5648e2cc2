// What went over the line, newest first: bytes, and what they mean.
// SPDX-License-Identifier: Apache-2.0
import type { Entry } from "./chip";
import { element } from "./dom";
import { checkOf, decode, RESULTS, shown } from "./protocol";

const KEPT = 2000, SHOWN = 60, STATES_PER_MS = 18432;

export class Log {
  readonly entries: Entry[] = [];
  private readonly list = element("log", HTMLOListElement);
  private frames = 0;
  private damaged = 0;
  private stale = true;

  constructor() {
    for (const id of ["show-telemetry", "show-heartbeats"]) element(id).onchange = () => { this.stale = true; this.draw(); };
    element("clear-log").onclick = () => this.clear();
  }

  clear(): void {
    this.entries.length = this.frames = this.damaged = 0;
    this.stale = true;
    this.draw();
  }

  add(entries: Entry[]): void {
    for (const entry of entries) {
      this.entries.push(entry);
      if (!entry.out && entry.result === 1) ++this.frames;
      if (!entry.out && entry.result > 1) ++this.damaged;
    }
    if (entries.length > 0) this.stale = true;
    if (this.entries.length > KEPT) this.entries.splice(0, this.entries.length - KEPT);
  }

  private wanted(entry: Entry): boolean {
    const code = parseInt(entry.body.slice(2, 4), 16);
    if (code >= 0xc0 && code < 0xff) return element("show-telemetry", HTMLInputElement).checked;
    if (code === 0x06 || code === 0x86) return element("show-heartbeats", HTMLInputElement).checked;
    return true;
  }

  draw(): void {
    // Whoever reads an opened entry does not lose it.
    if (!this.stale || this.list.querySelector("details[open]")) return;
    this.stale = false;
    const rows: HTMLLIElement[] = [];
    for (let i = this.entries.length - 1; i >= 0 && rows.length < SHOWN; --i) {
      const entry = this.entries[i];
      if (entry && this.wanted(entry)) rows.push(this.row(entry));
    }
    this.list.replaceChildren(...rows);
    element("counts").textContent = `${this.frames} frames from the board${this.damaged ? `, ${this.damaged} damaged` : ""}`;
  }

  private row(entry: Entry): HTMLLIElement {
    const row = document.createElement("li"), more = document.createElement("details"), line = document.createElement("summary");
    row.className = entry.out ? "out" : "in";
    const time = `${(entry.at / STATES_PER_MS).toFixed(0)} ms`;
    const arrow = entry.out ? "→ board" : "← board";
    const decoded = entry.result === 1 ? decode(entry.body) : null;
    const name = decoded ? decoded.message?.name ?? `0x${decoded.code.toString(16)}` : RESULTS[entry.result] ?? "?";
    const short = document.createElement("code");
    short.textContent = entry.wire;
    line.textContent = `${time} ${arrow} ${name}${decoded ? ` #${decoded.sequence}` : ""} `;
    line.append(short);
    const wire = document.createElement("code");
    wire.textContent = entry.wire.replace(/..(?=.)/g, "$& ");
    more.append(line, wire);
    if (decoded) {
      const crc = checkOf(entry.wire);
      const list = document.createElement("dl");
      const add = (term: string, text: string) => {
        const dt = document.createElement("dt"), dd = document.createElement("dd");
        dt.textContent = term;
        dd.textContent = text;
        list.append(dt, dd);
      };
      add("address, type, number", `${decoded.address}, 0x${decoded.code.toString(16).padStart(2, "0")}, ${decoded.sequence}`);
      if (decoded.message && !decoded.values) add("fields", "not as long as the message's");
      for (const field of decoded.values && decoded.message ? decoded.message.fields : [])
        add(field.name, shown(field, decoded.values?.[field.name] ?? 0, decoded.values ?? {}));
      if (crc !== null) add("CRC-16", `0x${crc.toString(16).padStart(4, "0")}, right`);
      more.append(list);
    }
    row.append(more);
    return row;
  }
}
