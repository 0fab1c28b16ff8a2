// The hand, as clay in its own frame: origin at the wrist, x towards the fingers, y towards the thumb, z out of its back
// (a right hand; mirror it for the left). It is sculpted once for a hand length of 1 = wrist to tip of the index finger.
import { Matrix4, Quaternion, Vector3 } from 'three';
import type { Digits } from './digits';
import { Blob } from './field';
import type { Region } from './sculpt';
import type { Vec } from './types';

/** metres from wrist to fingertip for which the blobs below are written */
const WRITTEN_LENGTH = 0.168;

/** the knuckle of the index finger */
export const KNUCKLE: Vec = [0.079, 0.026, 0.002];

const KNUCKLES: readonly Vec[] = [
  [0.082, 0.006, 0.004],
  [0.078, -0.014, 0.002],
  [0.07, -0.031, -0.003],
];

/** From the wrist to these knuckles, that of the index finger first. */
function palm(ends: readonly Vec[] = [KNUCKLE, ...KNUCKLES]): Blob[] {
  return [
    new Blob([-0.06, 0.004, 0], [0.008, 0.009, 0], 0.0165, 0.0185, 0.01),
    new Blob([-0.06, -0.004, 0], [0.008, -0.009, 0], 0.0165, 0.0185, 0.01),
    ...ends.map((end, i) => new Blob([0.004, 0.012 - 0.008 * i, 0], end, 0.0165, 0.0125 - 0.0008 * i, 0.018)),
  ];
}

/** The ball of a thumb that lies still. */
const thenar = (): Blob => new Blob([0.016, 0.016, -0.008], [0.05, 0.038, -0.02], 0.0165, 0.0135, 0.02);

/** Curled under the palm, the thumb laid against them. */
function curledFingers(): Blob[] {
  const fingers = KNUCKLES.flatMap(([x, y, z], i) => {
    const r = 0.0105 - 0.0007 * i;
    const reach = 1 - 0.08 * i;
    const middle: Vec = [x + 0.03 * reach, y, z - 0.026 * reach];
    const far: Vec = [x + 0.012 * reach, y + 0.002, z - 0.05 * reach];
    const tip: Vec = [x - 0.014 * reach, y + 0.003, z - 0.042 * reach];
    return [
      new Blob([x, y, z], middle, r + 0.0015, r, 0.006),
      new Blob(middle, far, r, r - 0.0005, 0.004),
      new Blob(far, tip, r - 0.0005, r - 0.0015, 0.004),
    ];
  });
  return [
    ...fingers,
    new Blob([0.05, 0.038, -0.02], [0.082, 0.032, -0.036], 0.0125, 0.0105, 0.008),
    new Blob([0.082, 0.032, -0.036], [0.104, 0.014, -0.044], 0.0105, 0.0085, 0.006),
  ];
}

/** All fingers a little bent, as a hanging hand has them. */
function restingFingers(): Blob[] {
  const fingers = [KNUCKLE, ...KNUCKLES].flatMap(([x, y, z], i) => {
    const r = 0.0102 - 0.0006 * i;
    const reach = [0.95, 1.05, 0.98, 0.8][i]!;
    const middle: Vec = [x + 0.04 * reach, y, z - 0.012 * reach];
    const far: Vec = [x + 0.062 * reach, y, z - 0.03 * reach];
    const tip: Vec = [x + 0.072 * reach, y, z - 0.05 * reach];
    return [
      new Blob([x, y, z], middle, r + 0.0015, r, 0.006),
      new Blob(middle, far, r, r - 0.0008, 0.004),
      new Blob(far, tip, r - 0.0008, r - 0.002, 0.004),
    ];
  });
  return [
    ...fingers,
    new Blob([0.05, 0.038, -0.02], [0.078, 0.044, -0.03], 0.0125, 0.0105, 0.008),
    new Blob([0.078, 0.044, -0.03], [0.102, 0.042, -0.038], 0.0105, 0.008, 0.006),
  ];
}

export const pointingHand = (): Blob[] => [...palm(), thenar(), ...curledFingers()];
export const restingHand = (): Blob[] => [...palm(), thenar(), ...restingFingers()];

/** A palm alone, with knuckles where they are given, that of the index finger first, and where its thumb begins. */
export const openHand = (knuckles: readonly Vec[], thumb: Vec | undefined): Blob[] => [
  ...palm(knuckles),
  ...(thumb ? [new Blob([0.004, 0.01, -0.002], thumb, 0.0165, 0.0155, 0.02)] : []),
];

export const HAND_REGION: Region = { low: [-0.05, -0.07, -0.08], high: [0.18, 0.08, 0.04], cell: 0.009 };

// Hands of the models this was made for hang down along -y, with the thumb towards +x, at rest.
const USUAL_DISTAL = new Vector3(0, -1, 0);
const USUAL_RADIAL = new Vector3(1, 0, 0);

/** how far knuckles are from the wrist in the hand as it is written (m) */
const WRITTEN_PALM = 0.081;

/** Finds, at the first moment, how the hand lies in its part, and from then on where it is. */
export class HandFrame {
  readonly matrix = new Matrix4();
  readonly distal = new Vector3();
  readonly radial = new Vector3();
  readonly dorsal = new Vector3();
  readonly knuckle = new Vector3();
  scale = 0;
  /** the farthest the fingertip was from the knuckle so far: then the finger was straight */
  fingerLength = 0;
  private readonly localDistal = new Vector3();
  private readonly localRadial = new Vector3();
  private readonly turn = new Quaternion();

  update(parts: Float32Array, part: number, wrist: Vector3, fingertip: Vector3, digits: Digits): void {
    this.turn.fromArray(parts, part * 7 + 3);
    if (!this.scale) {
      if (digits.length)
        this.scale = digits.settle(wrist, this.turn, this.localDistal, this.localRadial) / WRITTEN_PALM;
      else this.settle(wrist, fingertip);
    }
    this.distal.copy(this.localDistal).applyQuaternion(this.turn);
    this.radial.copy(this.localRadial).applyQuaternion(this.turn);
    this.dorsal.crossVectors(this.distal, this.radial);
    this.matrix.makeBasis(this.distal, this.radial, this.dorsal).setPosition(wrist);
    this.matrix.scale(this.knuckle.setScalar(this.scale));
    this.knuckle.fromArray(KNUCKLE).applyMatrix4(this.matrix);
    this.fingerLength = Math.max(this.fingerLength, this.knuckle.distanceTo(fingertip));
  }

  private settle(wrist: Vector3, fingertip: Vector3): void {
    const reach = wrist.distanceTo(fingertip);
    this.scale = Math.min(1.2, Math.max(0.75, reach / WRITTEN_LENGTH));
    const pointing = this.distal.subVectors(fingertip, wrist).normalize().applyQuaternion(this.turn.clone().invert());
    const usual = pointing.dot(USUAL_DISTAL) > 0.5;
    this.localDistal.copy(usual ? USUAL_DISTAL : pointing);
    this.localRadial.copy(usual || Math.abs(pointing.x) < 0.9 ? USUAL_RADIAL : USUAL_DISTAL);
    this.localRadial.addScaledVector(this.localDistal, -this.localRadial.dot(this.localDistal)).normalize();
  }
}
