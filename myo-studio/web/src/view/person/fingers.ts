// What of the hand moves, as clay: the one finger that points where the others are curled, or every finger along its joints.
import { Vector3 } from 'three';
import type { Digits } from './digits';
import type { HandFrame } from './hand';
import type { Limb } from './limb';
import type { Palette } from './palette';
import { type Tubes, aim } from './tubes';

export interface Fingers {
  paint(colors: Palette): void;
  update(limb: Limb): void;
}

const POINTING_FORM = [1.15, 1.12, 1.02, 1, 0.98, 0.92, 0.86, 0.78, 0.55, 0.02] as const;
const POINTING_PLACE = [-0.1, 0.08, 0.25, 0.42, 0.6, 0.74, 0.85, 0.93, 0.975, 1] as const;
const RADIUS = 0.0108;

/** where along its way from base to tip each ring of a digit lies, and how thick it is there */
const PLACE = [-0.12, -0.04, 0.04, 0.13, 0.22, 0.31, 0.4, 0.49, 0.58, 0.67, 0.75, 0.83, 0.9, 0.95, 0.985, 1] as const;
const FORM = [1.05, 1.12, 1.12, 1.08, 1.03, 1, 0.99, 1, 0.97, 0.93, 0.9, 0.88, 0.8, 0.66, 0.42, 0.02] as const;
/** a thumb begins at the wrist, as its ball */
const THUMB_FORM = [
  1.3, 1.45, 1.55, 1.6, 1.58, 1.48, 1.34, 1.22, 1.14, 1.1, 1.06, 1.02, 0.93, 0.76, 0.48, 0.02,
] as const;
/** of the fingers, that of the index first */
const THICKNESS = [0.98, 1, 0.95, 0.84] as const;
/** a finger is as round at a bend as over this stretch of its way (m) */
const ROUND = 0.005;
/** from the point of a fingertip to the skin before it, as a share of the radius */
const PULP = 0.35;

/** cross-sections of each tube */
export const fingerTubes = (digits: number): number[] =>
  digits ? Array<number>(digits).fill(PLACE.length) : [POINTING_FORM.length];

abstract class Clay implements Fingers {
  protected readonly at = new Float64Array(3);
  protected readonly along = new Float64Array(3);
  protected readonly out = new Float64Array(3);

  /** `first`: where in `tubes` the fingers begin */
  constructor(
    protected readonly tubes: Tubes,
    protected readonly first: number,
    private readonly rings: number,
  ) {}

  paint({ clay }: Palette): void {
    for (let ring = this.first; ring < this.first + this.rings; ring++) this.tubes.paint(ring, clay.r, clay.g, clay.b);
    this.tubes.painted();
  }

  abstract update(limb: Limb): void;
}

/** Straight when the fingertip is as far away as the finger is long, else bent upwards at its middle. */
export class PointingFinger extends Clay {
  constructor(tubes: Tubes, first: number) {
    super(tubes, first, POINTING_FORM.length);
  }

  update({ hand, fingertip }: Limb): void {
    this.lay(hand, fingertip);
  }

  private lay({ knuckle, dorsal, scale, fingerLength: length }: HandFrame, tip: Vector3): void {
    aim(knuckle, tip, this.along, this.out);
    const reach = knuckle.distanceTo(tip);
    const bend = 0.003 + 0.5 * Math.sqrt(Math.max(0, length * length - reach * reach));
    POINTING_PLACE.forEach((t, i) => {
      const lift = bend * Math.sin(Math.PI * Math.max(0, t)) * 0.7;
      this.at[0] = knuckle.x + t * (tip.x - knuckle.x) + lift * dorsal.x;
      this.at[1] = knuckle.y + t * (tip.y - knuckle.y) + lift * dorsal.y;
      this.at[2] = knuckle.z + t * (tip.z - knuckle.z) + lift * dorsal.z;
      const r = RADIUS * scale * POINTING_FORM[i]!;
      this.tubes.ring(this.first + i, this.at, this.along, this.out, r, r, i > 6 ? -1.2 : -0.05, 0);
    });
  }
}

/** Every finger and the thumb where the simulation has them. */
export class MovingFingers extends Clay {
  private readonly here = new Vector3();
  private readonly before = new Vector3();
  private readonly after = new Vector3();
  private readonly side = new Vector3();

  constructor(
    tubes: Tubes,
    first: number,
    private readonly digits: Digits,
  ) {
    super(tubes, first, digits.all.length * PLACE.length);
  }

  update({ hand }: Limb): void {
    const { thumb } = this.digits;
    let finger = 0;
    for (const digit of this.digits.order) {
      const thickness = digit === thumb ? 1 : THICKNESS[Math.min(finger++, THICKNESS.length - 1)]!;
      this.lay(digit, hand, digit === thumb ? THUMB_FORM : FORM, RADIUS * hand.scale * thickness);
    }
  }

  private lay(digit: number, { dorsal }: HandFrame, form: readonly number[], radius: number): void {
    const { here, before, after, side, at, out } = this;
    const points = this.digits.all[digit]!;
    const length = lengthOf(points) + PULP * radius;
    for (let i = 0; i < PLACE.length; i++) {
      const goal = PLACE[i]! * length;
      walk(points, goal - ROUND, before);
      walk(points, goal + ROUND, after);
      walk(points, goal, here).multiplyScalar(2).add(before).add(after).multiplyScalar(0.25);
      at[0] = here.x;
      at[1] = here.y;
      at[2] = here.z;
      aim(before, after, this.along, out);
      // Rings of one tube must not turn about it from one to the next.
      side.copy(dorsal).addScaledVector(here.subVectors(after, before).normalize(), -dorsal.dot(here));
      if (side.lengthSq() > 1e-4) side.normalize().toArray(out);
      const r = radius * form[i]!;
      const flare = i < PLACE.length - 4 ? 0 : -0.5 - 0.6 * (i - PLACE.length + 4);
      this.tubes.ring(this.first + digit * PLACE.length + i, at, this.along, out, r, r, flare, 0);
    }
  }
}

function lengthOf(points: readonly Vector3[]): number {
  let sum = 0;
  for (let k = 1; k < points.length; k++) sum += points[k]!.distanceTo(points[k - 1]!);
  return sum;
}

/** Goes so far along a way (m), and straight on before its beginning and behind its end. */
function walk(points: readonly Vector3[], goal: number, to: Vector3): Vector3 {
  let rest = goal;
  let k = 1;
  for (; k < points.length - 1; k++) {
    const piece = points[k]!.distanceTo(points[k - 1]!);
    if (rest <= piece) break;
    rest -= piece;
  }
  const [a, b] = [points[k - 1]!, points[k]!];
  return to.copy(b).sub(a).setLength(rest).add(a);
}
