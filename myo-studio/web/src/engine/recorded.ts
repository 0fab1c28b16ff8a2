import { Refused, type Engine, type Motion } from './engine';
import type { Calls, Look, Recorded, RunDetail } from './protocol';

/** An engine that knows what was recorded, and nothing else. */
export class RecordedEngine implements Engine {
  constructor(private readonly recorded: Recorded) {}

  async ask<Name extends keyof Calls>(call: Name, asked: Calls[Name]['with']): Promise<Calls[Name]['reply']> {
    const answers: Partial<Record<keyof Calls, () => unknown>> = {
      run: () => this.run((asked as { name: string }).name),
      body_of_run: () => this.find(({ entry }) => entry.name === (asked as { name: string }).name).body,
      look: () => this.look((asked as { text: string }).text),
      efforts: () => this.find(({ entry }) => entry.name === (asked as { name: string }).name).efforts,
      compare: () => this.recorded.table,
    };
    const answer = answers[call];
    if (!answer) throw refusal('A report only shows what was recorded; the studio can do more.');
    return answer() as Calls[Name]['reply'];
  }

  private find(is: (detail: RunDetail) => boolean) {
    const found = this.recorded.runs.find(({ detail }) => is(detail));
    if (!found) throw refusal('This report does not hold that run.');
    return found;
  }

  private run(name: string): RunDetail {
    return this.find(({ entry }) => entry.name === name).detail;
  }

  private look(text: string): Look {
    return { findings: [], view: this.find((detail) => detail.text === text).view };
  }

  async replay({ run }: { run: string }): Promise<Motion> {
    const { motion } = this.find(({ entry }) => entry.name === run);
    if (!motion) throw refusal('This run had no checkpoint yet.');
    return { header: motion.header, numbers: numbers(motion.numbers) };
  }

  async pose(): Promise<Motion> {
    throw refusal('A report only shows what was recorded.');
  }

  onEvent() {}
  onMotion() {}
  onConnection() {}
}

function refusal(message: string) {
  return new Refused({ message, findings: [] });
}

/** Numbers in single precision, little end first, from base 64. */
function numbers(text: string): Float32Array {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Float32Array.from({ length: bytes.length / 4 }, (_, index) => view.getFloat32(4 * index, true));
}
