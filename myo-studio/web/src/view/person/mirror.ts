// A left arm, seen in a mirror: what the person is made for is a right one.
import type { PersonPose, PersonShape } from './types';

/** numbers of a part: a place and a quaternion */
const PART = 7;

export class Mirror {
  private readonly points: number[];
  private readonly seen: { parts: Float32Array; muscles: Float32Array; fingertip: Float32Array };

  constructor(shape: PersonShape) {
    this.points = shape.muscles.map(({ points }) => points);
    const numbers = this.points.reduce((sum, points) => sum + 3 * points + 1, 0);
    this.seen = {
      parts: new Float32Array(PART * shape.parts.length),
      muscles: new Float32Array(numbers),
      fingertip: new Float32Array(3),
    };
  }

  /** The pose of the other arm that looks like this one in the mirror between left and right. It is good until the next. */
  of({ parts, muscles, fingertip }: PersonPose): PersonPose {
    const { seen } = this;
    seen.parts.set(parts);
    for (let at = 0; at < parts.length; at += PART) {
      // a turn about an axis becomes the opposite turn about the mirrored axis
      for (const k of [1, 3, 5]) seen.parts[at + k] = -seen.parts[at + k]!;
    }
    seen.muscles.set(muscles);
    let at = 0;
    for (const points of this.points) {
      for (let point = 0; point < points; point += 1) seen.muscles[at + 3 * point + 1]! *= -1;
      at += 3 * points + 1;
    }
    seen.fingertip.set(fingertip);
    seen.fingertip[1]! *= -1;
    return seen;
  }
}
