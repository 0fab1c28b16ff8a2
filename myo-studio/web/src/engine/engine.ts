import type { Calls, Event, MotionHeader, Pose, Refusal, Replay } from './protocol';

/** Why an engine did not do what it was asked: its sentence, and what it is about. */
export class Refused extends Error {
  constructor(readonly refusal: Refusal) {
    super(refusal.message);
  }
}

/** Frames of a movement: `header.frame_size` numbers each. */
export interface Motion {
  header: MotionHeader;
  numbers: Float32Array;
}

/** Whether the engine can be asked. */
export type Connection = 'connecting' | 'open' | 'lost' | 'refused';

/**
 * What the page needs of an engine, wherever that is: behind a socket today, in a worker of this page tomorrow.
 * The page knows nothing else of it.
 */
export interface Engine {
  ask<Name extends keyof Calls>(call: Name, asked: Calls[Name]['with']): Promise<Calls[Name]['reply']>;
  /** An episode of a run. */
  replay(asked: Replay): Promise<Motion>;
  /** The first moment of a task. */
  pose(asked: Pose): Promise<Motion>;
  /** Hears what happens by itself. */
  onEvent(hear: (event: Event) => void): void;
  /** Sees what is watched. */
  onMotion(see: (motion: Motion) => void): void;
  onConnection(hear: (connection: Connection) => void): void;
}
