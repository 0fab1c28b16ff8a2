import { Refused, type Connection, type Engine, type Motion } from './engine';
import type { Calls, Event, MotionHeader, Pose, Refusal, Replay } from './protocol';

type Answer = { id: number; ok?: unknown; refused?: Refusal };
type Waiting = { resolve: (answer: never) => void; reject: (why: Error) => void };

const RETRY_MS = 1000;

/** An engine behind a socket. It comes back by itself when the other side does; what was asked meanwhile is refused. */
export class SocketEngine implements Engine {
  private socket: WebSocket | undefined;
  private opened: Promise<void>;
  private open!: () => void;
  private next = 1;
  private readonly waiting = new Map<number, Waiting>();
  private readonly hearEvent: ((event: Event) => void)[] = [];
  private readonly seeMotion: ((motion: Motion) => void)[] = [];
  private readonly hearConnection: ((connection: Connection) => void)[] = [];

  constructor(private readonly url: string) {
    this.opened = new Promise((resolve) => (this.open = resolve));
    this.connect();
  }

  onEvent(hear: (event: Event) => void) {
    this.hearEvent.push(hear);
  }

  onMotion(see: (motion: Motion) => void) {
    this.seeMotion.push(see);
  }

  onConnection(hear: (connection: Connection) => void) {
    this.hearConnection.push(hear);
  }

  ask<Name extends keyof Calls>(call: Name, asked: Calls[Name]['with']): Promise<Calls[Name]['reply']> {
    return this.send(call, asked);
  }

  replay(asked: Replay): Promise<Motion> {
    return this.send('replay', asked);
  }

  pose(asked: Pose): Promise<Motion> {
    return this.send('pose', asked);
  }

  private async send<T>(call: string, asked: unknown): Promise<T> {
    await this.opened;
    const id = this.next++;
    return new Promise<T>((resolve, reject) => {
      this.waiting.set(id, { resolve: resolve as (answer: never) => void, reject });
      this.socket?.send(JSON.stringify({ id, call, with: asked }));
    });
  }

  private connect() {
    const socket = new WebSocket(this.url);
    let wasOpen = false;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      wasOpen = true;
      this.socket = socket;
      this.tell('open');
      this.open();
    };
    socket.onmessage = ({ data }) => (typeof data === 'string' ? this.hear(data) : this.see(data as ArrayBuffer));
    socket.onclose = () => this.lose(wasOpen);
  }

  private lose(wasOpen: boolean) {
    // The promise of an open socket is made anew, so that what is asked from now on waits for it.
    if (wasOpen) this.opened = new Promise((resolve) => (this.open = resolve));
    this.tell(wasOpen || this.socket ? 'lost' : 'refused');
    const why = { message: 'The studio was stopped before it answered.', findings: [] };
    this.waiting.forEach(({ reject }) => reject(new Refused(why)));
    this.waiting.clear();
    setTimeout(() => this.connect(), RETRY_MS);
  }

  private tell(connection: Connection) {
    this.hearConnection.forEach((hear) => hear(connection));
  }

  private hear(text: string) {
    const message = JSON.parse(text) as Event | Answer;
    if ('event' in message) {
      this.hearEvent.forEach((hear) => hear(message));
      return;
    }
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.refused) waiting?.reject(new Refused(message.refused));
    else waiting?.resolve(message.ok as never);
  }

  private see(bytes: ArrayBuffer) {
    const length = new DataView(bytes).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as MotionHeader;
    const motion = { header, numbers: new Float32Array(bytes, 4 + length) };
    if (header.id === null) {
      this.seeMotion.forEach((see) => see(motion));
      return;
    }
    const waiting = this.waiting.get(header.id);
    this.waiting.delete(header.id);
    waiting?.resolve(motion as never);
  }
}

/** The engine that served this page, with the token of its address. */
export function engineOfThisPage(): Engine {
  const token = new URLSearchParams(location.search).get('token');
  const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
  return new SocketEngine(`${scheme}://${location.host}/engine${token ? `?token=${encodeURIComponent(token)}` : ''}`);
}
