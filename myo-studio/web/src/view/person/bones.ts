// What the translucent arm holds besides muscles: slender bones, and the pointing finger, which is clay like the hand.
import type { Vector3 } from 'three';
import type { HandFrame } from './hand';
import type { Limb } from './limb';
import type { Palette } from './palette';
import type { Tubes } from './tubes';

const BONE_RINGS = 9;
const BONES = 3;
const FINGER_RINGS = 10;

/** cross-sections of each tube, in the order in which they are laid */
export const BONE_TUBES: readonly number[] = [...Array<number>(BONES).fill(BONE_RINGS), FINGER_RINGS];
const FINGER = BONES * BONE_RINGS;

/** thick ends, slender shaft, closed at both ends */
const BONE_FORM = [0.2, 1.1, 1.25, 0.85, 0.75, 0.8, 1.2, 1.1, 0.2] as const;
const BONE_PLACE = [-0.05, -0.03, 0.03, 0.14, 0.5, 0.84, 0.95, 1.0, 1.02] as const;
const FINGER_FORM = [1.15, 1.12, 1.02, 1, 0.98, 0.92, 0.86, 0.78, 0.55, 0.02] as const;
const FINGER_PLACE = [-0.1, 0.08, 0.25, 0.42, 0.6, 0.74, 0.85, 0.93, 0.975, 1] as const;
const FINGER_RADIUS = 0.0108;

export class Bones {
  private readonly at = new Float64Array(3);
  private readonly along = new Float64Array(3);
  private readonly out = new Float64Array(3);

  constructor(private readonly tubes: Tubes) {}

  paint({ bone, clay }: Palette): void {
    for (let ring = 0; ring < FINGER; ring++) this.tubes.paint(ring, bone.r, bone.g, bone.b);
    for (let ring = FINGER; ring < FINGER + FINGER_RINGS; ring++) this.tubes.paint(ring, clay.r, clay.g, clay.b);
    this.tubes.painted();
  }

  update({ shoulder, elbow, wrist, fingertip, hand }: Limb): void {
    this.aim(shoulder, elbow);
    this.layBone(0, shoulder, elbow, 0.013, hand.radial, 0);
    // Two bones turn about each other in the forearm: apart at the wrist, along the hand's width.
    this.layBone(1, elbow, wrist, 0.0088, hand.radial, 0.013);
    this.layBone(2, elbow, wrist, 0.0088, hand.radial, -0.013);
    this.layFinger(hand, fingertip);
  }

  private layBone(bone: number, from: Vector3, to: Vector3, radius: number, side: Vector3, apart: number): void {
    this.aim(from, to);
    for (let i = 0; i < BONE_RINGS; i++) {
      const t = BONE_PLACE[i]!;
      const shift = apart * Math.min(1, Math.max(0, 0.45 + 0.6 * t));
      this.at[0] = from.x + t * (to.x - from.x) + shift * side.x;
      this.at[1] = from.y + t * (to.y - from.y) + shift * side.y;
      this.at[2] = from.z + t * (to.z - from.z) + shift * side.z;
      const r = radius * BONE_FORM[i]!;
      this.tubes.ring(bone * BONE_RINGS + i, this.at, this.along, this.out, r, r, 0, 0);
    }
  }

  /** Straight when the fingertip is as far away as the finger is long, else bent upwards at its middle. */
  private layFinger({ knuckle, dorsal, scale, fingerLength: length }: HandFrame, tip: Vector3): void {
    this.aim(knuckle, tip);
    const reach = knuckle.distanceTo(tip);
    const bend = 0.003 + 0.5 * Math.sqrt(Math.max(0, length * length - reach * reach));
    for (let i = 0; i < FINGER_RINGS; i++) {
      const t = FINGER_PLACE[i]!;
      const lift = bend * Math.sin(Math.PI * Math.max(0, t)) * 0.7;
      this.at[0] = knuckle.x + t * (tip.x - knuckle.x) + lift * dorsal.x;
      this.at[1] = knuckle.y + t * (tip.y - knuckle.y) + lift * dorsal.y;
      this.at[2] = knuckle.z + t * (tip.z - knuckle.z) + lift * dorsal.z;
      const r = FINGER_RADIUS * scale * FINGER_FORM[i]!;
      this.tubes.ring(FINGER + i, this.at, this.along, this.out, r, r, i > 6 ? -1.2 : -0.05, 0);
    }
  }

  /** Sets `along` and any direction `out` at a right angle to it; round tubes do not mind which. */
  private aim(from: Vector3, to: Vector3): void {
    const { along, out } = this;
    const x = to.x - from.x;
    const y = to.y - from.y;
    const z = to.z - from.z;
    const length = Math.sqrt(x * x + y * y + z * z) + 1e-9;
    along[0] = x / length;
    along[1] = y / length;
    along[2] = z / length;
    const level = Math.hypot(x, y);
    if (level < 1e-4 * length) {
      out[0] = 1;
      out[1] = 0;
      out[2] = 0;
      return;
    }
    out[0] = (-along[2] * x) / level;
    out[1] = (-along[2] * y) / level;
    out[2] = level / length;
  }
}
