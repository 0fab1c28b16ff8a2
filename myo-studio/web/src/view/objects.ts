import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  EdgesGeometry,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
  type Raycaster,
} from 'three';
import { OBJECT, type ObjectKind, type ObjectView } from '../engine/protocol';

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
  ground: number;
}

const LIGHT: Palette = {
  target: 0x2f6fb3,
  bystander: 0x9aa3af,
  done: 0x6aa184,
  wrong: 0xc8372d,
  selected: 0x0b57d0,
  ground: 0xf3f4f6,
};
const DARK: Palette = {
  target: 0x6aa9ee,
  bystander: 0x69717d,
  done: 0x6fb592,
  wrong: 0xff6b5e,
  selected: 0x9cc8ff,
  ground: 0x14171c,
};

/** Parts that something may have in the task. */
const enum Role {
  Current,
  Later,
  Done,
  Bystander,
}

/** What can be seen through. */
const GLASS: ObjectKind[] = ['sphere', 'obstacle', 'slider'];

// Shapes of size one, which each object stretches.
const BALL = new SphereGeometry(1, 24, 16);
const BOX = new BoxGeometry(2, 2, 2);
const ROD = new CylinderGeometry(1, 1, 1, 12).rotateX(Math.PI / 2);
const BOX_EDGES = new EdgesGeometry(BOX).getAttribute('position') as BufferAttribute;
const UNIT_EDGES = new EdgesGeometry(new BoxGeometry(1, 1, 1));
const EDGES = BOX_EDGES.count;

/** Where one thing is, how large, and what it is painted like. */
interface Body {
  at: Vector3;
  turn: Quaternion;
  half: Vector3;
  tone: Color;
  opacity: number;
  edge: Color;
}

/** Many things of one shape, drawn in one go: a draw call costs more than a hundred triangles. */
class Swarm {
  readonly mesh: InstancedMesh<BufferGeometry, MeshLambertMaterial>;
  private readonly opacity: InstancedBufferAttribute;
  private readonly matrix = new Matrix4();

  /** `numbers` tells which things these are. */
  constructor(
    shape: BufferGeometry,
    readonly numbers: number[],
    isGlass: boolean,
  ) {
    const material = new MeshLambertMaterial({
      transparent: isGlass,
      depthWrite: !isGlass,
      // Edges lie on the faces, and before them.
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    const own = shape.clone();
    this.opacity = new InstancedBufferAttribute(new Float32Array(numbers.length).fill(1), 1);
    own.setAttribute('instanceOpacity', this.opacity);
    if (isGlass) material.onBeforeCompile = seeThrough;
    this.mesh = new InstancedMesh(own, material, numbers.length);
    // Where they are changes all the time, and they are few.
    this.mesh.frustumCulled = false;
  }

  draw(bodies: Body[]) {
    this.numbers.forEach((number, index) => {
      const { at, turn, half, tone, opacity } = bodies[number];
      this.mesh.setMatrixAt(index, this.matrix.compose(at, turn, half));
      this.mesh.setColorAt(index, tone);
      this.opacity.setX(index, opacity);
    });
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
    this.opacity.needsUpdate = true;
    this.mesh.boundingSphere = null;
  }

  dispose() {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.mesh.dispose();
  }
}

/** Lets every instance have an opacity of its own. */
function seeThrough(shader: { vertexShader: string; fragmentShader: string }) {
  shader.vertexShader = `attribute float instanceOpacity;\nvarying float vOpacity;\n${shader.vertexShader}`.replace(
    '#include <begin_vertex>',
    '#include <begin_vertex>\nvOpacity = instanceOpacity;',
  );
  shader.fragmentShader = `varying float vOpacity;\n${shader.fragmentShader}`.replace(
    '#include <color_fragment>',
    '#include <color_fragment>\ndiffuseColor.a *= vOpacity;',
  );
}

/** The edges of all boxes as lines of one drawing. */
class Edges {
  readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly position: BufferAttribute;
  private readonly color: BufferAttribute;
  private readonly corner = new Vector3();

  constructor(readonly numbers: number[]) {
    const geometry = new BufferGeometry();
    this.position = new BufferAttribute(new Float32Array(3 * EDGES * numbers.length), 3);
    this.color = new BufferAttribute(new Float32Array(3 * EDGES * numbers.length), 3);
    geometry.setAttribute('position', this.position);
    geometry.setAttribute('color', this.color);
    this.lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
    this.lines.frustumCulled = false;
  }

  draw(bodies: Body[]) {
    this.numbers.forEach((number, index) => {
      const { at, turn, half, edge } = bodies[number];
      for (let k = 0; k < EDGES; k++) {
        this.corner.fromBufferAttribute(BOX_EDGES, k).multiply(half).applyQuaternion(turn).add(at);
        this.position.setXYZ(EDGES * index + k, this.corner.x, this.corner.y, this.corner.z);
        this.color.setXYZ(EDGES * index + k, edge.r, edge.g, edge.b);
      }
    });
    this.position.needsUpdate = true;
    this.color.needsUpdate = true;
  }

  dispose() {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}

/** What few things have besides their body: a handle, a rod, a range of places. */
class Extras {
  readonly group = new Group();
  private readonly handle: Mesh<BufferGeometry, MeshLambertMaterial> | undefined;
  private readonly rod: Mesh<BufferGeometry, MeshLambertMaterial> | undefined;
  private readonly range: LineSegments<BufferGeometry, LineBasicMaterial> | undefined;

  constructor(
    private view: ObjectView,
    hasRange: boolean,
  ) {
    const part = (shape: BufferGeometry) =>
      new Mesh<BufferGeometry, MeshLambertMaterial>(shape, new MeshLambertMaterial());
    if (view.handle) this.group.add((this.handle = part(BOX)));
    if (view.hinge) this.group.add((this.rod = part(ROD)));
    if (hasRange) {
      this.range = new LineSegments(UNIT_EDGES, new LineBasicMaterial({ transparent: true }));
      this.range.matrixAutoUpdate = false;
      this.group.add(this.range);
    }
  }

  /** Where the task has them, and as far off that as the body is. */
  rest(view: ObjectView, body: Body) {
    this.view = view;
    const off = body.at.clone().sub(new Vector3(...view.at));
    if (this.handle && view.handle) {
      this.handle.position.set(...view.handle[0]).add(off);
      this.handle.quaternion.set(...view.rotation);
      this.handle.scale.set(...view.handle[1]);
    }
    this.stand(body, off);
    if (!this.range) return;
    const [a, b, c] = view.drawn.map((way, axis) => widened(new Vector3(...way), axis));
    this.range.matrix.makeBasis(a, b, c).setPosition(body.at);
    this.range.visible = true;
  }

  /** Where a frame has them. */
  follow(body: Body) {
    this.stand(body, new Vector3());
    if (this.range) this.range.visible = false;
  }

  /** The rod of a stick goes from its hinge to its knob. */
  private stand(body: Body, off: Vector3) {
    if (!this.rod || !this.view.hinge) return;
    const hinge = new Vector3(...this.view.hinge).add(off);
    this.rod.position.copy(hinge).add(body.at).multiplyScalar(0.5);
    this.rod.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), body.at.clone().sub(hinge).normalize());
    const thin = 0.35 * body.half.x;
    this.rod.scale.set(thin, thin, body.at.distanceTo(hinge));
  }

  paint(body: Body, palette: Palette, look: Look) {
    this.handle?.material.color.copy(body.tone).lerp(new Color(0xffffff), 0.35);
    this.rod?.material.color.set(palette.bystander);
    if (!this.range) return;
    this.range.material.color.set(look.wrong ? palette.wrong : palette.target);
    this.range.material.opacity = look.selected ? 0.9 : 0.35;
  }

  dispose() {
    [this.handle, this.rod, this.range].forEach((part) => part?.material.dispose());
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
  private views: ObjectView[] = [];
  private bodies: Body[] = [];
  private extras: (Extras | undefined)[] = [];
  private swarms: Swarm[] = [];
  private edges: Edges | undefined;
  private palette: Palette;
  /** What tells how each was done; roles in the task do without. */
  private tones: (number | undefined)[] | undefined;
  /** What is in the hand, where each was when it was taken, and how far it has come. */
  private held: { indices: number[]; from: Vector3[]; way: Vector3 } | undefined;

  constructor(dark: boolean) {
    this.palette = dark ? DARK : LIGHT;
  }

  setTheme(dark: boolean) {
    this.palette = dark ? DARK : LIGHT;
  }

  /** Paints things by how they were done, from the next painting on. */
  tint(tones: (number | undefined)[] | undefined) {
    this.tones = tones;
  }

  /** Shows what a task says, as it stands there. */
  show(views: ObjectView[], look: (index: number) => Look) {
    const same = views.length === this.views.length && views.every((view, index) => isAlike(view, this.views[index]));
    this.views = views;
    if (!same) this.build();
    views.forEach(({ at, rotation, half_size }, index) => place(this.bodies[index], at, rotation, half_size));
    this.keepInHand();
    this.paint(look);
  }

  /** Makes what is drawn, for other things than before. */
  private build() {
    this.dispose();
    const { views } = this;
    this.bodies = views.map(() => ({
      at: new Vector3(),
      turn: new Quaternion(),
      half: new Vector3(),
      tone: new Color(),
      opacity: 1,
      edge: new Color(),
    }));
    const which = (is: (view: ObjectView) => boolean) => views.flatMap((view, index) => (is(view) ? [index] : []));
    const isBox = (view: ObjectView) => view.kind !== 'sphere' && view.kind !== 'stick';
    // The handle of a slider is seen through its way.
    const isGlass = (view: ObjectView) => GLASS.includes(view.kind);
    this.swarms = [
      new Swarm(
        BOX,
        which((view) => isBox(view) && !isGlass(view)),
        false,
      ),
      new Swarm(
        BALL,
        which((view) => view.kind === 'stick'),
        false,
      ),
      new Swarm(
        BOX,
        which((view) => isBox(view) && isGlass(view)),
        true,
      ),
      new Swarm(
        BALL,
        which((view) => view.kind === 'sphere'),
        true,
      ),
    ].filter(({ numbers }) => numbers.length > 0);
    this.edges = new Edges(which(isBox));
    this.extras = views.map((view, index) => {
      // Copies of one description have one range.
      const isFirst = index === 0 || views[index - 1].path !== view.path;
      const hasRange = isFirst && view.drawn.some((way) => Math.hypot(...way) > 0);
      return view.handle || view.hinge || hasRange ? new Extras(view, hasRange) : undefined;
    });
    this.group.add(...this.swarms.map(({ mesh }) => mesh), this.edges.lines);
    this.extras.forEach((extras) => extras && this.group.add(extras.group));
  }

  private dispose() {
    this.group.clear();
    this.swarms.forEach((swarm) => swarm.dispose());
    this.extras.forEach((extras) => extras?.dispose());
    this.edges?.dispose();
  }

  /** Moves what is in the hand at once: what the engine says of it comes later, and about where it was. */
  pull(indices: number[], way: Vector3) {
    if (this.held && this.held.indices.join() !== indices.join()) this.held = undefined;
    const places = indices.map((index) => this.bodies[index]?.at.clone() ?? new Vector3());
    this.held ??= { indices, from: places, way: new Vector3() };
    this.held.way.add(way);
    this.keepInHand();
    this.draw();
  }

  letGo() {
    this.held = undefined;
  }

  private keepInHand() {
    const { held } = this;
    held?.indices.forEach((index, k) => this.bodies[index]?.at.copy(held.from[k]).add(held.way));
    this.views.forEach((view, index) => this.extras[index]?.rest(view, this.bodies[index]));
  }

  paint(look: (index: number) => Look) {
    this.views.forEach((view, index) =>
      this.color(index, view.steps.length > 0 ? Role.Current : Role.Bystander, look(index)),
    );
    this.draw();
  }

  /** Colours by part in the task. */
  private color(index: number, role: Role, look: Look) {
    const { palette } = this;
    const [view, body] = [this.views[index], this.bodies[index]];
    const tones = { [Role.Current]: palette.target, [Role.Later]: palette.target, [Role.Done]: palette.done };
    const result = this.tones?.[index];
    const plain = role === Role.Bystander ? palette.bystander : tones[role];
    body.tone.set(look.wrong ? palette.wrong : (result ?? plain));
    // What tells a result is as strong all the time; only the edge says what is to do now.
    const strength = result !== undefined ? 1.35 : role === Role.Current ? 1 : role === Role.Later ? 0.6 : 0.5;
    const isMarked = look.selected || (result !== undefined && role === Role.Current);
    body.edge.set(isMarked ? palette.selected : body.tone.getHex());
    if (look.selected) body.tone.lerp(new Color(palette.selected), 0.5);
    body.opacity = (view.kind === 'obstacle' ? 0.35 : 0.38) * strength + (look.selected ? 0.15 : 0);
    // What is solid fades into the ground instead.
    if (!GLASS.includes(view.kind)) body.tone.lerp(new Color(palette.ground), 0.9 * Math.max(0, 1 - strength));
    this.extras[index]?.paint(body, palette, look);
  }

  private draw() {
    this.swarms.forEach((swarm) => swarm.draw(this.bodies));
    this.edges?.draw(this.bodies);
  }

  /** Shows where a frame has everything. */
  follow(numbers: Float32Array, isSelected: (index: number) => boolean) {
    if (numbers.length !== OBJECT * this.views.length) return;
    this.bodies.forEach((body, index) => {
      const own = numbers.subarray(OBJECT * index, OBJECT * (index + 1));
      place(body, own.subarray(0, 3), own.subarray(3, 7), own.subarray(7, 10));
      this.extras[index]?.follow(body);
      this.color(index, own[11], { selected: isSelected(index), wrong: false });
    });
    this.draw();
  }

  /** What a ray meets first, and where. */
  hit(ray: Raycaster): { object: number; point: Vector3 } | undefined {
    const meshes = this.swarms.map(({ mesh }) => mesh);
    const [first] = ray.intersectObjects(meshes, false);
    if (first?.instanceId === undefined) return undefined;
    const swarm = this.swarms.find(({ mesh }) => mesh === first.object);
    return swarm && { object: swarm.numbers[first.instanceId], point: first.point };
  }

  /** About how far it goes from its middle (m). */
  extent(index: number): number {
    const { half } = this.bodies[index];
    return 0.85 * Math.max(half.x, half.y, half.z);
  }

  place(index: number): Vector3 | undefined {
    return this.bodies[index]?.at;
  }
}

function place(body: Body, at: ArrayLike<number>, turn: ArrayLike<number>, half: ArrayLike<number>) {
  body.at.set(at[0], at[1], at[2]);
  body.turn.set(turn[0], turn[1], turn[2], turn[3]);
  body.half.set(half[0], half[1], half[2]);
}

/** Whether one can be drawn by what was made for the other. */
function isAlike(a: ObjectView, b: ObjectView): boolean {
  const drawn = (view: ObjectView) => view.drawn.some((way) => Math.hypot(...way) > 0);
  return (
    a.kind === b.kind && a.path === b.path && drawn(a) === drawn(b) && !a.handle === !b.handle && !a.hinge === !b.hinge
  );
}
