import {
  BoxGeometry,
  BufferGeometry,
  Color,
  CylinderGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { OBJECT, type ObjectView } from '../engine/protocol';

/** How something stands out. */
export interface Look {
  selected: boolean;
  wrong: boolean;
}

interface Palette {
  target: number;
  bystander: number;
  done: number;
  wrong: number;
  selected: number;
  range: number;
}

const LIGHT: Palette = {
  target: 0x2f6fb3,
  bystander: 0x9aa3af,
  done: 0x6aa184,
  wrong: 0xc8372d,
  selected: 0x0b57d0,
  range: 0x2f6fb3,
};
const DARK: Palette = {
  target: 0x6aa9ee,
  bystander: 0x69717d,
  done: 0x6fb592,
  wrong: 0xff6b5e,
  selected: 0x9cc8ff,
  range: 0x6aa9ee,
};

// Shapes of size one, which each object stretches.
const BALL = new SphereGeometry(1, 24, 16);
const BOX = new BoxGeometry(2, 2, 2);
const BOX_EDGES = new EdgesGeometry(BOX);
const ROD = new CylinderGeometry(1, 1, 1, 12).rotateX(Math.PI / 2);
const UNIT_EDGES = new EdgesGeometry(new BoxGeometry(1, 1, 1));

/** One thing of a task, in the middle of where it may be, or where a frame has it. */
class Thing {
  readonly group = new Group();
  readonly body: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly edges: LineSegments<BufferGeometry, LineBasicMaterial> | undefined;
  private readonly handle: Mesh<BufferGeometry, MeshLambertMaterial> | undefined;
  private readonly rod: Mesh<BufferGeometry, MeshLambertMaterial> | undefined;
  private readonly range: LineSegments<BufferGeometry, LineBasicMaterial> | undefined;

  constructor(
    readonly view: ObjectView,
    readonly index: number,
    private palette: Palette,
  ) {
    const isRound = view.kind === 'sphere' || view.kind === 'stick';
    const material = new MeshLambertMaterial({ transparent: true });
    this.body = new Mesh<BufferGeometry, MeshLambertMaterial>(isRound ? BALL : BOX, material);
    this.body.userData.object = index;
    this.group.add(this.body);
    if (!isRound) {
      this.edges = new LineSegments(BOX_EDGES, new LineBasicMaterial({ transparent: true }));
      this.group.add(this.edges);
    }
    if (view.handle) this.group.add((this.handle = this.part(BOX)));
    if (view.hinge) this.group.add((this.rod = this.part(ROD)));
    const drawn = view.drawn.some((way) => Math.hypot(...way) > 0);
    if (drawn)
      this.group.add((this.range = new LineSegments(UNIT_EDGES, new LineBasicMaterial({ transparent: true }))));
    this.rest();
  }

  private part(shape: BufferGeometry) {
    const mesh = new Mesh<BufferGeometry, MeshLambertMaterial>(shape, new MeshLambertMaterial());
    mesh.userData.object = this.index;
    return mesh;
  }

  /** Where the task has it. */
  rest() {
    const { view } = this;
    this.place(view.at, view.rotation, view.half_size);
    if (this.handle && view.handle) {
      this.handle.position.set(...view.handle[0]);
      this.handle.quaternion.set(...view.rotation);
      this.handle.scale.set(...view.handle[1]);
    }
    this.stand(new Vector3(...view.at));
    if (this.range) {
      // Where the centre may be, and as much more as it is large.
      const [a, b, c] = view.drawn.map((way, axis) => widened(new Vector3(...way), axis));
      const frame = new Matrix4().makeBasis(a, b, c).setPosition(...view.at);
      this.range.matrixAutoUpdate = false;
      this.range.matrix.copy(frame);
      this.range.visible = true;
    }
  }

  /** Where a frame has it; returns its part in the task. */
  follow(numbers: Float32Array): number {
    const at = OBJECT * this.index;
    const read = (from: number, count: number) => Array.from(numbers.subarray(at + from, at + from + count));
    this.place(read(0, 3), read(3, 4), read(7, 3));
    this.stand(new Vector3(...(read(0, 3) as [number, number, number])));
    if (this.range) this.range.visible = false;
    return numbers[at + 11];
  }

  /** Moves what is drawn, until the text says where it is. */
  nudge(way: Vector3) {
    this.body.position.add(way);
    this.edges?.position.add(way);
    this.handle?.position.add(way);
    if (this.rod) this.rod.position.add(way);
    if (this.range) this.range.matrix.premultiply(new Matrix4().makeTranslation(way));
  }

  private place(at: number[], rotation: number[], half: number[]) {
    for (const mesh of [this.body, this.edges]) {
      mesh?.position.set(at[0], at[1], at[2]);
      mesh?.quaternion.set(rotation[0], rotation[1], rotation[2], rotation[3]);
      mesh?.scale.set(half[0], half[1], half[2]);
    }
  }

  /** The rod of a stick goes from its hinge to its knob. */
  private stand(knob: Vector3) {
    if (!this.rod || !this.view.hinge) return;
    const hinge = new Vector3(...this.view.hinge);
    this.rod.position.copy(hinge).add(knob).multiplyScalar(0.5);
    this.rod.quaternion.copy(
      new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), knob.clone().sub(hinge).normalize()),
    );
    const thin = 0.35 * this.view.half_size[0];
    this.rod.scale.set(thin, thin, knob.distanceTo(hinge));
  }

  /** Colours by part in the task: 0 current, 1 later, 2 done, 3 bystander. */
  paint(role: number, look: Look) {
    const { palette, view } = this;
    const tone = look.wrong
      ? palette.wrong
      : role === 2
        ? palette.done
        : role === 3
          ? palette.bystander
          : palette.target;
    const strength = role === 0 ? 1 : role === 1 ? 0.6 : 0.5;
    const isRound = view.kind === 'sphere';
    const { material } = this.body;
    material.color.set(tone);
    material.opacity =
      (isRound ? 0.38 : view.kind === 'obstacle' ? 0.35 : 0.85) * strength + (look.selected ? 0.15 : 0);
    // What can be seen through does not hide what is behind it.
    material.depthWrite = !isRound && view.kind !== 'obstacle';
    material.emissive.set(look.selected ? palette.selected : 0).multiplyScalar(look.selected ? 0.35 : 0);
    this.edges?.material.color.set(look.selected ? palette.selected : tone);
    if (this.edges) this.edges.material.opacity = look.selected ? 1 : 0.7;
    this.handle?.material.color.set(tone).lerp(new Color(0xffffff), 0.35);
    this.rod?.material.color.set(palette.bystander);
    if (this.range) {
      this.range.material.color.set(look.wrong ? palette.wrong : palette.range);
      this.range.material.opacity = look.selected ? 0.9 : 0.35;
    }
  }

  setPalette(palette: Palette) {
    this.palette = palette;
  }
}

/** A side of a box that is drawn, never quite flat. */
function widened(way: Vector3, axis: number): Vector3 {
  if (way.lengthSq() > 0) return way;
  return new Vector3().setComponent(axis, 1e-4);
}

/** Everything that stands in a task. */
export class Objects {
  readonly group = new Group();
  private things: Thing[] = [];
  private palette: Palette;
  /** What is in the hand, where each was when it was taken, and how far it has come. */
  private held: { indices: number[]; from: Vector3[]; way: Vector3 } | undefined;

  constructor(dark: boolean) {
    this.palette = dark ? DARK : LIGHT;
  }

  setTheme(dark: boolean) {
    this.palette = dark ? DARK : LIGHT;
    this.things.forEach((thing) => thing.setPalette(this.palette));
  }

  /** Shows what a task says, as it stands there. */
  show(views: ObjectView[], look: (index: number) => Look) {
    const same =
      views.length === this.things.length && views.every((view, index) => isAlike(view, this.things[index].view));
    if (!same) {
      this.things.forEach((thing) => dispose(thing.group));
      this.group.clear();
      this.things = views.map((view, index) => new Thing(view, index, this.palette));
      this.things.forEach((thing) => this.group.add(thing.group));
    } else {
      views.forEach((view, index) => {
        Object.assign(this.things[index].view, view);
        this.things[index].rest();
      });
    }
    this.keepInHand();
    this.paint(look);
  }

  /** Moves what is in the hand at once: what the engine says of it comes later, and about where it was. */
  pull(indices: number[], way: Vector3) {
    const places = indices.map((index) => this.things[index]?.body.position.clone() ?? new Vector3());
    if (this.held && this.held.indices.join() !== indices.join()) this.held = undefined;
    this.held ??= { indices, from: places, way: new Vector3() };
    this.held.way.add(way);
    this.keepInHand();
  }

  letGo() {
    this.held = undefined;
  }

  private keepInHand() {
    this.held?.indices.forEach((index, k) => {
      const thing = this.things[index];
      if (thing && this.held) thing.nudge(this.held.from[k].clone().add(this.held.way).sub(thing.body.position));
    });
  }

  paint(look: (index: number) => Look) {
    this.things.forEach((thing, index) => thing.paint(thing.view.steps.length > 0 ? 0 : 3, look(index)));
  }

  /** Shows where a frame has everything. */
  follow(numbers: Float32Array, isSelected: (index: number) => boolean) {
    if (numbers.length !== OBJECT * this.things.length) return;
    this.things.forEach((thing, index) =>
      thing.paint(thing.follow(numbers), { selected: isSelected(index), wrong: false }),
    );
  }

  /** What can be pointed at. */
  get targets(): Object3D[] {
    return this.things.map((thing) => thing.body);
  }

  place(index: number): Vector3 | undefined {
    return this.things[index]?.body.position;
  }
}

/** Whether one can be drawn by stretching the other. */
function isAlike(a: ObjectView, b: ObjectView): boolean {
  const drawn = (view: ObjectView) => view.drawn.some((way) => Math.hypot(...way) > 0);
  return a.kind === b.kind && drawn(a) === drawn(b) && !a.handle === !b.handle && !a.hinge === !b.hinge;
}

function dispose(group: Group) {
  group.traverse((part) => {
    if (part instanceof Mesh || part instanceof LineSegments) (part.material as LineBasicMaterial).dispose();
  });
}
