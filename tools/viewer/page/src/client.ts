// A client of Foxglove's WebSocket protocol, with the player's control of its SDK. It comes back by itself.
// SPDX-License-Identifier: Apache-2.0
import { Reader } from "./ros1";

export interface PlaybackState { status: number; seconds: number; speed: number }
export interface Info { capabilities: string[]; end: number | undefined }
const HAND = 1;  // this client's number of its channel /hand
type Handler = (reader: Reader, seconds: number, data: DataView) => void;

export class Client {
  onState: (open: boolean) => void = () => {};
  onInfo: (info: Info) => void = () => {};
  onPlayback: (state: PlaybackState) => void = () => {};
  onTime: (seconds: number) => void = () => {};
  onRefusal: (sentence: string) => void = () => {};
  onParameter: (name: string, value: string) => void = () => {};
  private readonly handlers = new Map<string, Handler>();
  private topics = new Map<number, string>();
  private socket: WebSocket | undefined;
  private delay = 250;
  private watched: string | undefined;

  // The server that is there now refuses this address, which has no token or that of another run. Started with
  // --view-open, it lets one look without.
  refused = false;
  private suspected = false;

  constructor(private readonly url: string, private readonly token: string | null) {}

  on(topic: string, handler: Handler): void { this.handlers.set(topic, handler); }
  // Those that the server offers, with a name that begins so; `onTopics` says that there are more.
  offered(prefix: string): string[] { return [...this.topics.values()].filter((name) => name.startsWith(prefix)); }
  onTopics: () => void = () => {};

  // From now on, also of the server that comes after this one; the one before it is wanted no more.
  watch(topic: string | undefined): void {
    if (this.watched !== undefined && this.handlers.delete(this.watched)) this.say("unsubscribe", this.watched);
    this.watched = topic;
    if (topic === undefined) return;
    this.handlers.set(topic, (reader, seconds, data) => this.onWatched(reader, seconds, data));
    this.say("subscribe", topic);
  }
  onWatched: Handler = () => {};

  private say(op: "subscribe" | "unsubscribe", topic: string): void {
    const id = [...this.topics].find(([, name]) => name === topic)?.[0];
    if (id === undefined || this.socket?.readyState !== WebSocket.OPEN) return;
    this.socket.send(JSON.stringify(op === "subscribe"
      ? { op, subscriptions: [{ id, channelId: id }] } : { op, subscriptionIds: [id] }));
  }

  open(): void {
    const asked = this.token !== null && !this.refused;
    const url = asked ? `${this.url}?token=${encodeURIComponent(this.token ?? "")}` : this.url;
    const socket = new WebSocket(url, ["foxglove.sdk.v1", "foxglove.websocket.v1"]);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.topics = new Map();
    let opened = false;
    socket.onopen = () => {
      opened = true;
      this.suspected = false;
      this.delay = 250;
      this.onState(true);
    };
    socket.onclose = async () => {
      if (opened) this.refused = false;
      else await this.suspect();
      this.onState(false);
      setTimeout(() => this.open(), this.delay);
      this.delay = Math.min(2 * this.delay, 4000);
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === "string") this.text(data);
      else this.binary(new DataView(data));
    };
  }

  // A browser does not tell why a socket was not opened: a server that answers before and after an attempt
  // has refused it.
  private async suspect(): Promise<void> {
    const there = await fetch("/", { cache: "no-store" }).then(() => true, () => false);
    this.refused = there && (this.refused || this.suspected);
    this.suspected = there;
  }

  // A line of what is to be done by hand; only for who has the token.
  hand(line: string): void {
    if (this.socket?.readyState !== WebSocket.OPEN) return;
    const text = new TextEncoder().encode(JSON.stringify({ do: line }));
    const data = new Uint8Array(5 + text.length);
    data[0] = 1;
    new DataView(data.buffer).setUint32(1, HAND, true);
    data.set(text, 5);
    this.socket.send(data);
  }

  control(play: boolean, speed: number, seek?: number): void {
    if (this.socket?.readyState !== WebSocket.OPEN) return;
    const view = new DataView(new ArrayBuffer(19));
    view.setUint8(0, 3);
    view.setUint8(1, play ? 0 : 1);
    view.setFloat32(2, speed, true);
    view.setUint8(6, seek === undefined ? 0 : 1);
    view.setBigUint64(7, BigInt(Math.round((seek ?? 0) * 1e9)), true);
    this.socket.send(view.buffer);
  }

  private text(data: string): void {
    const message = JSON.parse(data) as {
      op: string; capabilities?: string[]; dataEndTime?: { sec: number; nsec: number }; message?: string;
      channels?: { id: number; topic: string }[]; parameters?: { name: string; value?: unknown }[];
    };
    if (message.op === "serverInfo") {
      const end = message.dataEndTime;
      if (message.capabilities?.includes("clientPublish")) this.socket?.send(JSON.stringify({ op: "advertise",
        channels: [{ id: HAND, topic: "/hand", encoding: "json", schemaName: "" }] }));
      if (message.capabilities?.includes("parameters"))
        this.socket?.send(JSON.stringify({ op: "getParameters", parameterNames: [] }));
      this.onInfo({ capabilities: message.capabilities ?? [], end: end && end.sec + 1e-9 * end.nsec });
    } else if (message.op === "advertise") {
      for (const { id, topic } of message.channels ?? []) this.topics.set(id, topic);
      this.onTopics();
      const wanted = (message.channels ?? []).filter(({ topic }) => this.handlers.has(topic));
      if (wanted.length === 0) return;
      const subscriptions = wanted.map(({ id }) => ({ id, channelId: id }));
      this.socket?.send(JSON.stringify({ op: "subscribe", subscriptions }));
    } else if (message.op === "parameterValues") {
      for (const { name, value } of message.parameters ?? []) this.onParameter(name, String(value));
    } else if (message.op === "status") {
      this.onRefusal(message.message ?? "");
    }
  }

  private binary(view: DataView): void {
    const seconds = (at: number) => Number(view.getBigUint64(at, true)) * 1e-9;
    switch (view.getUint8(0)) {
      case 1: {
        const topic = this.topics.get(view.getUint32(1, true));
        const data = new DataView(view.buffer, 13);
        if (topic !== undefined) this.handlers.get(topic)?.(new Reader(data), seconds(5), data);
        break;
      }
      case 2: this.onTime(seconds(1)); break;
      case 5:
        this.onPlayback({ status: view.getUint8(1), seconds: seconds(2), speed: view.getFloat32(10, true) });
        break;
    }
  }
}
