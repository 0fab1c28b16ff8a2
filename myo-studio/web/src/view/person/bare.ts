// A body of which nothing is known but its parts and its muscles, such as a pair of legs: its bones and muscles alone, bones as they look
// where its model tells.
import { Box3, Group, Mesh, MeshLambertMaterial, Quaternion, Sphere, Vector3 } from 'three';
import type { BoneShape } from '../../engine/protocol';
import { BONE_RINGS, layBone, paintBones } from './bones';
import { Looks } from './looks';
import { type Clay, Muscles } from './muscles';
import { type Palette, palette } from './palette';
import { ringsPerMuscle } from './spindle';
import { Tubes } from './tubes';
import type { Figure, Near, PersonPose, PersonShape, Theme } from './types';

const PART = 7;
/** how much thinner a bone is than long, and how thick it may be (m) */
const SLENDER = 0.06;
const THICKEST = 0.016;
/** nothing is farther in than this of what the camera stands near to (m) */
const SMALLEST = 0.05;
/** from the lowest bone down to the floor (m): what is around a foot's joints */
const SOLE = 0.03;

const NOTHING: Clay = { core: [], skin: [] };

export class Bare implements Figure {
  readonly group = new Group();
  readonly size = 1;
  readonly isLeft: boolean;
  near: Near | undefined;
  floor: number | undefined;

  private readonly painted = new MeshLambertMaterial({ vertexColors: true });
  private readonly sticks: BoneShape[];
  private readonly tubes: Tubes;
  private readonly muscles: Muscles;
  private readonly looks: Looks;
  private colors: Palette;
  private readonly from = new Vector3();
  private readonly to = new Vector3();
  private readonly origin = new Vector3();
  private readonly turn = new Quaternion();

  constructor(
    private readonly shape: PersonShape,
    theme: Theme,
  ) {
    const { bones, looks, muscles, is_left } = shape;
    // Where it is known how a part looks, no stick is drawn.
    this.sticks = bones.filter(({ parts }) => !looks.some(({ part }) => part === parts[0]));
    this.isLeft = is_left;
    const bellies = Array<number>(muscles.length).fill(ringsPerMuscle(muscles.length));
    const count = this.sticks.length;
    this.tubes = new Tubes([...Array<number>(count).fill(BONE_RINGS), ...bellies], count);
    this.muscles = new Muscles(shape, this.tubes, count * BONE_RINGS, () => 'arm');
    this.colors = palette(theme);
    const all = new Mesh(this.tubes.geometry, this.painted);
    all.frustumCulled = false;
    this.looks = new Looks(looks);
    this.group.add(all, this.looks.group);
    this.group.visible = false;
    this.setTheme(theme);
  }

  pose({ parts, muscles }: PersonPose): void {
    const { from, to } = this;
    this.looks.update(parts);
    this.sticks.forEach((stick, bone) => {
      this.place(parts, stick, 0, from);
      this.place(parts, stick, 1, to);
      const radius = Math.min(THICKEST, SLENDER * from.distanceTo(to));
      layBone(this.tubes, bone * BONE_RINGS, from, to, radius);
    });
    this.muscles.update(muscles, NOTHING, this.colors);
    this.tubes.moved();
    this.near ??= this.around(parts, muscles);
    this.group.visible = true;
  }

  private place(parts: Float32Array, bone: BoneShape, end: number, to: Vector3): Vector3 {
    const at = bone.parts[end]! * PART;
    this.turn.fromArray(parts, at + 3);
    return to.fromArray(bone.ends[end]!).applyQuaternion(this.turn).add(this.origin.fromArray(parts, at));
  }

  /** The ball around its bones and muscles; the floor is under the lowest. */
  private around(parts: Float32Array, muscles: Float32Array): Near {
    const places = this.shape.bones.flatMap((bone) => [0, 1].map((end) => this.place(parts, bone, end, new Vector3())));
    let at = 0;
    for (const { points } of this.shape.muscles) {
      for (let point = 0; point < points; point += 1) places.push(new Vector3().fromArray(muscles, at + 3 * point));
      at += 3 * points + 1;
    }
    const box = new Box3().setFromPoints(places);
    const ball = box.isEmpty() ? new Sphere(new Vector3(), 0) : box.getBoundingSphere(new Sphere());
    this.floor = (box.isEmpty() ? 0 : box.min.z) - SOLE;
    return { at: ball.center.toArray(), radius: Math.max(SMALLEST, ball.radius) };
  }

  setTheme(theme: Theme): void {
    this.colors = palette(theme);
    paintBones(this.tubes, this.sticks.length, this.colors);
    this.muscles.paint(this.colors);
    this.looks.paint(this.colors);
  }

  setFirstPerson(): void {
    // It has no eyes of its own.
  }

  setSitting(): void {
    // It stands as it stands.
  }

  setRough(on: boolean): void {
    this.tubes.setRough(on);
  }

  /** From behind and above. */
  eye(): { position: [number, number, number]; forward: [number, number, number] } {
    const { at, radius } = this.near ?? { at: [0, 0, 0], radius: 1 };
    return { position: [at[0] - 2 * radius, at[1], at[2] + radius], forward: [0.9, 0, -0.44] };
  }

  dispose(): void {
    this.painted.dispose();
    this.tubes.geometry.dispose();
    this.looks.dispose();
  }
}
