// The person: a calm clay figure whose right arm is moved by the simulation and shows its muscles through its skin.
// It brings no lights; it is tuned for one hemisphere light and one directional light (about 1.6 and 1.9 strong).
import { type BufferGeometry, Group, Mesh, MeshLambertMaterial } from 'three';
import { Bare } from './bare';
import { Bones, BONE_TUBES } from './bones';
import { bodyGeometry, handGeometry, headGeometry, palmGeometry, stoolGeometry } from './body';
import { EYE, FIGURE } from './figure';
import { type Fingers, MovingFingers, PointingFinger, fingerTubes } from './fingers';
import { Mirror } from './mirror';
import { Limb } from './limb';
import { Muscles } from './muscles';
import { type Palette, palette } from './palette';
import { Shadow } from './shadow';
import { Skin } from './skin';
import { ringsPerMuscle } from './spindle';
import { Tubes } from './tubes';
import type { Figure, Near, PersonPose, PersonShape, Theme } from './types';

export type { Figure, PersonPose, PersonShape, Theme } from './types';
export { floorHeight } from './figure';

/** A person around an arm, or what there is of another body. */
export const figureOf = (shape: PersonShape, theme: Theme): Figure =>
  shape.is_person ? new Person(shape, theme) : new Bare(shape, theme);

/** from the wrist to the middle of a hand (m) */
const HALF_HAND = 0.08;

/** how much larger the triangles of a rough body are */
const ROUGH = 1.7;

class Person implements Figure {
  readonly group = new Group();
  /** how many times as tall as the figure as it is made */
  readonly size: number;
  readonly isLeft: boolean;
  near: Near | undefined;
  readonly floor = undefined;

  /** what does not move, as large as the person is */
  private readonly still = new Group();
  private readonly mirror: Mirror | undefined;

  private readonly clay = new MeshLambertMaterial({ vertexColors: true });
  private readonly painted = new MeshLambertMaterial({ vertexColors: true });
  private readonly wood = new MeshLambertMaterial();
  private readonly body = new Mesh(bodyGeometry(false), this.clay);
  private readonly head = new Mesh(headGeometry(), this.clay);
  /** of a hand whose fingers move, made at the first pose */
  private readonly palm: Mesh;
  private isPalmMade: boolean;
  private readonly stool = new Mesh(stoolGeometry(), this.wood);
  private readonly shadow = new Shadow();
  private readonly skin: Skin;
  /** what the simulation moves; not shown before the first pose */
  private readonly arm = new Group();
  private readonly limb: Limb;
  private readonly tubes: Tubes;
  private readonly bones: Bones;
  private readonly fingers: Fingers;
  private readonly muscles: Muscles;
  private colors: Palette;
  private sitting = false;
  private isRough = false;
  /** for each posture, made when it is needed first: fine, and rough */
  private readonly bodies = new Map<string, BufferGeometry>();

  constructor(
    private readonly shape: PersonShape,
    theme: Theme,
  ) {
    const bellies = Array<number>(shape.muscles.length).fill(ringsPerMuscle(shape.muscles.length));
    this.limb = new Limb(shape);
    const { digits } = this.limb;
    const fingers = fingerTubes(digits.length);
    this.tubes = new Tubes([...BONE_TUBES, ...fingers, ...bellies], BONE_TUBES.length + fingers.length);
    this.bones = new Bones(this.tubes);
    const first = sum(BONE_TUBES);
    this.fingers = digits.length ? new MovingFingers(this.tubes, first, digits) : new PointingFinger(this.tubes, first);
    this.isPalmMade = !digits.length;
    this.palm = new Mesh(this.isPalmMade ? handGeometry() : undefined, this.clay);
    this.muscles = new Muscles(shape, this.tubes, first + sum(fingers));
    this.skin = new Skin([...this.limb.skin, ...this.muscles.bulges]);
    this.size = (shape.stature_m ?? FIGURE) / FIGURE;
    this.still.scale.setScalar(this.size);
    this.isLeft = shape.is_left;
    this.mirror = shape.is_left ? new Mirror(shape) : undefined;
    // Everything is made as for a right arm, and seen in a mirror.
    if (this.mirror) this.group.scale.y = -1;
    this.colors = palette(theme);
    this.bodies.set('false false', this.body.geometry);

    const inside = new Mesh(this.tubes.geometry, this.painted);
    inside.frustumCulled = false;
    this.palm.matrixAutoUpdate = false;
    this.arm.add(inside, this.palm, this.skin.group);
    this.arm.visible = false;
    this.still.add(this.body, this.head, this.stool, this.shadow.mesh);
    this.group.add(this.still, this.arm);
    this.stool.visible = false;
    this.shadow.setSitting(false);
    this.setTheme(theme);
  }

  pose(given: PersonPose): void {
    const pose = this.mirror?.of(given) ?? given;
    this.limb.update(pose);
    this.palm.matrix.copy(this.limb.hand.matrix);
    this.palm.matrixWorldNeedsUpdate = true;
    if (!this.isPalmMade) this.palm.geometry = palmGeometry(this.limb.hand, this.limb.digits);
    this.isPalmMade = true;
    this.bones.update(this.limb);
    this.fingers.update(this.limb);
    this.muscles.update(pose.muscles, this.limb, this.colors);
    this.tubes.moved();
    this.skin.update(this.limb);
    if (this.shape.moves_hand_only) this.near ??= this.aroundHand();
    this.arm.visible = true;
  }

  private aroundHand(): Near {
    const { wrist, hand } = this.limb;
    const [x, y, z] = wrist
      .clone()
      .addScaledVector(hand.distal, HALF_HAND * hand.scale)
      .toArray();
    return { at: [x, this.mirror ? -y : y, z], radius: 2.35 * HALF_HAND * hand.scale };
  }

  setTheme(theme: Theme): void {
    this.colors = palette(theme);
    this.clay.color.copy(this.colors.clay);
    this.wood.color.copy(this.colors.stool);
    this.shadow.setPalette(this.colors);
    this.skin.setPalette(this.colors);
    this.bones.paint(this.colors);
    this.fingers.paint(this.colors);
    this.muscles.paint(this.colors);
  }

  setFirstPerson(on: boolean): void {
    this.head.visible = !on;
  }

  setSitting(on: boolean): void {
    if (this.sitting === on) return;
    this.sitting = on;
    this.reshape();
    this.stool.visible = on;
    this.shadow.setSitting(on);
  }

  setRough(on: boolean): void {
    if (this.isRough === on) return;
    this.isRough = on;
    this.tubes.setRough(on);
    this.skin.setRough(on);
    this.reshape();
  }

  private reshape(): void {
    const key = `${this.sitting} ${this.isRough}`;
    const made = this.bodies.get(key) ?? bodyGeometry(this.sitting, this.isRough ? ROUGH : 1);
    this.bodies.set(key, made);
    this.body.geometry = made;
  }

  eye(): { position: [number, number, number]; forward: [number, number, number] } {
    const [x, y, z] = EYE;
    const side = this.mirror ? -1 : 1;
    return {
      position: [this.size * x, side * this.size * y, this.size * z],
      forward: [0.93, side * -0.06, -0.36],
    };
  }

  dispose(): void {
    for (const mesh of [this.head, this.palm, this.stool]) mesh.geometry.dispose();
    for (const geometry of this.bodies.values()) geometry.dispose();
    for (const material of [this.clay, this.painted, this.wood]) material.dispose();
    this.tubes.geometry.dispose();
    this.skin.dispose();
    this.shadow.dispose();
  }
}

const sum = (numbers: readonly number[]): number => numbers.reduce((total, number) => total + number, 0);
