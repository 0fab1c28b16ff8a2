import { MOMENT, OBJECT, PART, type MotionHeader, type MotionLayout } from '../engine/protocol';
import type { Motion } from '../engine/engine';

/** One moment of a movement: views into a frame, which stay where they are. */
export interface Moment {
  time_s: number;
  episode: number;
  step: number;
  fingertip: Float32Array;
  pointer: Float32Array;
  force_n: number;
  parts: Float32Array;
  muscles: Float32Array;
  joints: Float32Array;
  objects: Float32Array;
}

/** Where the parts of a frame begin. */
function offsets(layout: MotionLayout) {
  const parts = MOMENT;
  const muscles = parts + PART * layout.parts;
  const joints = muscles + layout.muscle_points.reduce((sum, points) => sum + 3 * points + 1, 0);
  const objects = joints + layout.joints;
  return { parts, muscles, joints, objects, end: objects + OBJECT * layout.objects };
}

/** The moment that a frame holds. */
export function moment(frame: Float32Array, layout: MotionLayout): Moment {
  const at = offsets(layout);
  return {
    time_s: frame[0],
    episode: frame[1],
    step: frame[2],
    fingertip: frame.subarray(3, 6),
    pointer: frame.subarray(6, 9),
    force_n: frame[9],
    parts: frame.subarray(at.parts, at.muscles),
    muscles: frame.subarray(at.muscles, at.joints),
    joints: frame.subarray(at.joints, at.objects),
    objects: frame.subarray(at.objects, at.end),
  };
}

/** Between two frames: numbers in proportion, directions by the shorter way. What is counted stays that of the first. */
export function between(a: Float32Array, b: Float32Array, share: number, layout: MotionLayout, out: Float32Array) {
  const at = offsets(layout);
  for (let k = 0; k < out.length; k++) out[k] = a[k] + (b[k] - a[k]) * share;
  [out[1], out[2]] = [a[1], a[2]];
  for (let part = 0; part < layout.parts; part++) turn(a, b, share, out, at.parts + PART * part + 3);
  for (let object = 0; object < layout.objects; object++) {
    const own = at.objects + OBJECT * object;
    turn(a, b, share, out, own + 3);
    out[own + 11] = a[own + 11];
  }
}

function turn(a: Float32Array, b: Float32Array, share: number, out: Float32Array, at: number) {
  let dot = 0;
  for (let k = at; k < at + 4; k++) dot += a[k] * b[k];
  const sign = dot < 0 ? -1 : 1;
  let length = 0;
  for (let k = at; k < at + 4; k++) {
    out[k] = a[k] + (sign * b[k] - a[k]) * share;
    length += out[k] * out[k];
  }
  for (let k = at; k < at + 4; k++) out[k] /= Math.sqrt(length);
}

/** Frames in a row, played at any speed; more may come while it plays. */
export class Film {
  private frames: Float32Array[] = [];
  private scratch: Float32Array;
  readonly layout: MotionLayout;
  readonly frame_s: number;

  constructor(readonly header: MotionHeader) {
    this.layout = header.layout;
    this.frame_s = header.frame_s;
    this.scratch = new Float32Array(header.frame_size);
  }

  static of(motion: Motion): Film {
    const film = new Film(motion.header);
    film.add(motion.numbers);
    return film;
  }

  add(numbers: Float32Array) {
    const size = this.header.frame_size;
    for (let at = 0; at + size <= numbers.length; at += size) this.frames.push(numbers.subarray(at, at + size));
  }

  get length() {
    return this.frames.length;
  }

  /** Its duration (s). */
  get duration_s() {
    return Math.max(0, this.frames.length - 1) * this.frame_s;
  }

  frame(index: number): Moment {
    return moment(this.frames[Math.max(0, Math.min(this.frames.length - 1, index))], this.layout);
  }

  /** The moment at a time since its beginning (s); the same arrays every time. */
  at(time_s: number): Moment {
    const place = Math.max(0, Math.min(this.frames.length - 1, time_s / this.frame_s));
    const index = Math.min(Math.floor(place), Math.max(0, this.frames.length - 2));
    const [a, b] = [this.frames[index], this.frames[Math.min(index + 1, this.frames.length - 1)]];
    // From the end of an episode to the beginning of the next nothing moves.
    if (a[1] !== b[1] || b[0] < a[0]) this.scratch.set(a);
    else between(a, b, place - index, this.layout, this.scratch);
    return moment(this.scratch, this.layout);
  }

  /** Forgets what was before a time (s); how much that was. */
  forget(time_s: number): number {
    const count = Math.max(0, Math.min(this.frames.length - 2, Math.floor(time_s / this.frame_s)));
    this.frames.splice(0, count);
    return count * this.frame_s;
  }
}
