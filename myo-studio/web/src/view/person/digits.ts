// Fingers and thumb that the simulation moves: where their joints and tips are, and how a hand lies that has them.
import { Quaternion, Vector3 } from 'three';
import type { PersonPose, PersonShape } from './types';

/** a thumb begins nearer to the wrist than this share of where fingers begin */
const NEAR = 0.75;

const PART = 7;

export class Digits {
  /** of each digit its joints and its tip */
  readonly all: readonly Vector3[][];
  /** numbers of the digits, the thumb first and then from the index to the little finger; in any order before `settle` */
  order: number[];
  thumb: number | undefined;
  private readonly shapes: PersonShape['digits'];
  private readonly turn = new Quaternion();

  private readonly tips: Vector3[];

  constructor({ digits: shapes, is_left }: Pick<PersonShape, 'digits' | 'is_left'>) {
    this.shapes = shapes;
    // A left hand is seen in a mirror, and so are places on its parts.
    this.tips = shapes.map(({ tip: [x, y, z] }) => new Vector3(x, is_left ? -y : y, z));
    this.all = shapes.map(({ parts }) => [...parts, 0].map(() => new Vector3()));
    this.order = shapes.map((_, digit) => digit);
  }

  get length(): number {
    return this.all.length;
  }

  update({ parts }: PersonPose): void {
    this.shapes.forEach((shape, digit) => {
      const points = this.all[digit]!;
      shape.parts.forEach((part, k) => points[k]!.fromArray(parts, part * PART));
      const last = shape.parts[shape.parts.length - 1]!;
      this.turn.fromArray(parts, last * PART + 3);
      const tip = points[shape.parts.length]!;
      tip
        .copy(this.tips[digit]!)
        .applyQuaternion(this.turn)
        .add(points[shape.parts.length - 1]!);
    });
  }

  /**
   * Finds which digit is the thumb, and in which directions the fingers and the thumb lie, as seen in the hand's part from its
   * wrist; returns how far knuckles are from there.
   */
  settle(wrist: Vector3, turn: Quaternion, distal: Vector3, radial: Vector3): number {
    const back = turn.clone().invert();
    const bases = this.all.map(([base]) => base!.clone().sub(wrist).applyQuaternion(back));
    const middle = (of: Vector3[]) => of.reduce((sum, base) => sum.add(base), new Vector3()).divideScalar(of.length);
    const nearest = bases.reduce((best, base, digit) => (base.length() < bases[best]!.length() ? digit : best), 0);
    const others = bases.filter((_, digit) => digit !== nearest);
    const isThumb = others.length > 0 && bases[nearest]!.length() < NEAR * middle(others).length();
    this.thumb = isThumb ? nearest : undefined;
    const fingers = isThumb ? others : bases;
    const centre = middle(fingers);
    distal.copy(centre).normalize();
    radial.subVectors(bases[nearest]!, centre);
    radial.addScaledVector(distal, -radial.dot(distal)).normalize();
    const rank = (digit: number) => (digit === this.thumb ? Infinity : bases[digit]!.dot(radial));
    this.order.sort((a, b) => rank(b) - rank(a));
    return fingers.reduce((sum, base) => sum + base.length(), 0) / fingers.length;
  }
}
