// The simulated arm of one moment: where its joints are, and the soft clay made from them. `core` is what muscles lie
// on (the chest and the bones), `skin` is what covers them (the chest and the flesh of the arm).
import { Vector3 } from 'three';
import { Digits } from './digits';
import { Blob } from './field';
import { MIDDLE, chest } from './figure';
import { HandFrame } from './hand';
import type { PersonPose, PersonShape } from './types';

/** how far the skin lies above the clay of the chest */
const SKIN = 0.007;

/** A tapered stretch of bone or flesh between two fractions of a bone's length. */
class Stretch {
  constructor(
    readonly blob: Blob,
    private readonly from: number,
    private readonly to: number,
  ) {}

  place(a: Vector3, b: Vector3, shiftX: number, shiftY: number, shiftZ: number): void {
    const { from, to } = this;
    this.blob.place(
      a.x + from * (b.x - a.x) + shiftX,
      a.y + from * (b.y - a.y) + shiftY,
      a.z + from * (b.z - a.z) + shiftZ,
      a.x + to * (b.x - a.x) + shiftX,
      a.y + to * (b.y - a.y) + shiftY,
      a.z + to * (b.z - a.z) + shiftZ,
    );
  }
}

const stretch = (from: number, to: number, ra: number, rb: number, melt: number): Stretch =>
  new Stretch(new Blob([0, 0, 0], [0, 0, 0], ra, rb, melt), from, to);

function skinOfChest(): Blob[] {
  const blobs = chest();
  for (const blob of blobs) {
    blob.ra += SKIN;
    blob.rb += SKIN;
  }
  return blobs;
}

export class Limb {
  readonly shoulder = new Vector3();
  readonly elbow = new Vector3();
  readonly wrist = new Vector3();
  readonly fingertip = new Vector3();
  /** a little way into the palm, where the skin ends */
  readonly palm = new Vector3();
  readonly hand = new HandFrame();
  readonly digits: Digits;

  private readonly upperBones = [stretch(0, 0, 0.025, 0.025, 0.02), stretch(0, 1, 0.014, 0.014, 0.02)];
  private readonly lowerBones = [stretch(0, 1, 0.014, 0.01, 0.02)];
  private readonly upperFlesh = [
    stretch(0, 0.42, 0.051, 0.048, 0.04),
    stretch(0.3, 0.62, 0.048, 0.048, 0.012),
    stretch(0.62, 1, 0.048, 0.037, 0.012),
  ];
  private readonly lowerFlesh = [stretch(0, 0.26, 0.036, 0.0425, 0.014), stretch(0.26, 0.7, 0.0425, 0.03, 0.012)];
  private readonly wristFlesh = [stretch(0.6, 1, 0.029, 0.0205, 0.012), stretch(0.6, 1, 0.029, 0.0205, 0.012)];
  private readonly palmFlesh = stretch(0, 1, 0.0205, 0.017, 0.012);
  private readonly girdle = new Blob([0, 0, 0], [0, 0, 0], 0.04, 0.044, 0.05);

  readonly core: Blob[] = [...chest(), ...[...this.upperBones, ...this.lowerBones].map((bone) => bone.blob)];
  readonly skin: Blob[] = [
    ...skinOfChest(),
    this.girdle,
    ...[...this.upperFlesh, ...this.lowerFlesh, ...this.wristFlesh, this.palmFlesh].map((flesh) => flesh.blob),
  ];

  private readonly parts: readonly number[];

  constructor(shape: PersonShape) {
    this.parts = shape.limb;
    this.digits = new Digits(shape);
  }

  update(pose: PersonPose): void {
    const hand = this.parts[this.parts.length - 1]!;
    this.shoulder.fromArray(pose.parts, this.parts[0]! * 7);
    this.elbow.fromArray(pose.parts, this.parts[1]! * 7);
    this.wrist.fromArray(pose.parts, hand * 7);
    this.fingertip.fromArray(pose.fingertip);
    this.digits.update(pose);
    this.hand.update(pose.parts, hand, this.wrist, this.fingertip, this.digits);
    this.palm.copy(this.wrist).addScaledVector(this.hand.distal, 0.03 * this.hand.scale);
    this.placeBlobs();
  }

  private placeBlobs(): void {
    const { shoulder: s, elbow: e, wrist: w } = this;
    for (const bone of this.upperBones) bone.place(s, e, 0, 0, 0);
    for (const bone of this.lowerBones) bone.place(e, w, 0, 0, 0);
    for (const flesh of this.upperFlesh) flesh.place(s, e, 0, 0, 0);
    for (const flesh of this.lowerFlesh) flesh.place(e, w, 0, 0, 0);
    // Two blobs side by side: the wrist is wider than thick, and shows how the forearm is turned.
    const side = this.hand.radial;
    this.wristFlesh[0]!.place(e, w, 0.008 * side.x, 0.008 * side.y, 0.008 * side.z);
    this.wristFlesh[1]!.place(e, w, -0.008 * side.x, -0.008 * side.y, -0.008 * side.z);
    this.palmFlesh.place(w, this.palm, 0, 0, 0);
    this.girdle.place(-0.036, MIDDLE - 0.115, 0.016, s.x - 0.008, s.y, s.z + 0.01);
  }
}
