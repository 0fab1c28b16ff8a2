// Slender bones: those in the translucent arm, and those of a body of which nothing else is drawn.
import { Vector3 } from 'three';
import type { Limb } from './limb';
import type { Palette } from './palette';
import { type Tubes, aim } from './tubes';

export const BONE_RINGS = 9;
const BONES = 3;

/** cross-sections of each tube, in the order in which they are laid */
export const BONE_TUBES: readonly number[] = Array<number>(BONES).fill(BONE_RINGS);

/** thick ends, slender shaft, closed at both ends */
const BONE_FORM = [0.2, 1.1, 1.25, 0.85, 0.75, 0.8, 1.2, 1.1, 0.2] as const;
const BONE_PLACE = [-0.05, -0.03, 0.03, 0.14, 0.5, 0.84, 0.95, 1.0, 1.02] as const;

const at = new Float64Array(3);
const along = new Float64Array(3);
const out = new Float64Array(3);
const NO_SIDE = new Vector3();

/** Lays a bone between two joints, the far end a little to a side. */
export function layBone(
  tubes: Tubes,
  first: number,
  from: Vector3,
  to: Vector3,
  radius: number,
  side = NO_SIDE,
  apart = 0,
): void {
  aim(from, to, along, out);
  for (let i = 0; i < BONE_RINGS; i++) {
    const t = BONE_PLACE[i]!;
    const shift = apart * Math.min(1, Math.max(0, 0.45 + 0.6 * t));
    at[0] = from.x + t * (to.x - from.x) + shift * side.x;
    at[1] = from.y + t * (to.y - from.y) + shift * side.y;
    at[2] = from.z + t * (to.z - from.z) + shift * side.z;
    const r = radius * BONE_FORM[i]!;
    tubes.ring(first + i, at, along, out, r, r, 0, 0);
  }
}

/** Paints so many bones, the first tubes of all. */
export function paintBones(tubes: Tubes, count: number, { bone }: Palette): void {
  for (let ring = 0; ring < count * BONE_RINGS; ring++) tubes.paint(ring, bone.r, bone.g, bone.b);
  tubes.painted();
}

/** The bones of the arm. */
export class Bones {
  constructor(private readonly tubes: Tubes) {}

  paint(colors: Palette): void {
    paintBones(this.tubes, BONES, colors);
  }

  update({ shoulder, elbow, wrist, hand }: Limb): void {
    layBone(this.tubes, 0, shoulder, elbow, 0.013);
    // Two bones turn about each other in the forearm: apart at the wrist, along the hand's width.
    layBone(this.tubes, BONE_RINGS, elbow, wrist, 0.0088, hand.radial, 0.013);
    layBone(this.tubes, 2 * BONE_RINGS, elbow, wrist, 0.0088, hand.radial, -0.013);
  }
}
