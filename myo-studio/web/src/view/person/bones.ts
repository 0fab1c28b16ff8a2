// What the translucent arm holds besides muscles: slender bones.
import type { Vector3 } from 'three';
import type { Limb } from './limb';
import type { Palette } from './palette';
import { type Tubes, aim } from './tubes';

const BONE_RINGS = 9;
const BONES = 3;

/** cross-sections of each tube, in the order in which they are laid */
export const BONE_TUBES: readonly number[] = Array<number>(BONES).fill(BONE_RINGS);

/** thick ends, slender shaft, closed at both ends */
const BONE_FORM = [0.2, 1.1, 1.25, 0.85, 0.75, 0.8, 1.2, 1.1, 0.2] as const;
const BONE_PLACE = [-0.05, -0.03, 0.03, 0.14, 0.5, 0.84, 0.95, 1.0, 1.02] as const;

export class Bones {
  private readonly at = new Float64Array(3);
  private readonly along = new Float64Array(3);
  private readonly out = new Float64Array(3);

  constructor(private readonly tubes: Tubes) {}

  paint({ bone }: Palette): void {
    for (let ring = 0; ring < BONES * BONE_RINGS; ring++) this.tubes.paint(ring, bone.r, bone.g, bone.b);
    this.tubes.painted();
  }

  update({ shoulder, elbow, wrist, hand }: Limb): void {
    this.layBone(0, shoulder, elbow, 0.013, hand.radial, 0);
    // Two bones turn about each other in the forearm: apart at the wrist, along the hand's width.
    this.layBone(1, elbow, wrist, 0.0088, hand.radial, 0.013);
    this.layBone(2, elbow, wrist, 0.0088, hand.radial, -0.013);
  }

  private layBone(bone: number, from: Vector3, to: Vector3, radius: number, side: Vector3, apart: number): void {
    aim(from, to, this.along, this.out);
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
}
