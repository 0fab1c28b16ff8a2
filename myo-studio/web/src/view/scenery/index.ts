// Quiet things that say where a task happens. From where one would stand before the arm or what is to do, one looks
// through it.
import {
  BoxGeometry,
  BufferGeometry,
  CylinderGeometry,
  ExtrudeGeometry,
  Group,
  Line3,
  LineBasicMaterial,
  LineLoop,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Plane,
  Shape,
  ShapeGeometry,
  Vector3,
  type Camera,
  type Material,
} from 'three';
import type { Plan, Slab, Table } from './plan';

interface Palette {
  body: number;
  screen: number;
  lens: number;
  top: number;
  leg: number;
  line: number;
}

const LIGHT: Palette = {
  body: 0x8b939f,
  screen: 0xffffff,
  lens: 0x5b6470,
  top: 0xd8cdbd,
  leg: 0xa9adb4,
  line: 0x9aa3af,
};
const DARK: Palette = {
  body: 0x77828f,
  screen: 0x2b323c,
  lens: 0x8b95a2,
  top: 0x5b5349,
  leg: 0x48505b,
  line: 0x69717d,
};

/** After the grid, before all the rest. */
const ORDER = -1;

/** So far things may reach into a slab and are still seen (m): a finger that presses, a ball to be touched. */
const DEEP = 0.03;

/** The arm as it hangs (m). */
const ARM = [0, -0.15, -0.3, -0.4, -0.5, -0.6].map((z) => new Vector3(0.02, 0, z));

export class Scenery {
  readonly group = new Group();
  private solid = new Group();
  private ghost = new Group();
  /** Its front, and whether a place of that is within its edges. */
  private front: { plane: Plane; isOn: (place: Vector3) => boolean } | undefined;
  private parts: { geometry: BufferGeometry; material: Material }[] = [];
  private made = '';

  /** Builds what is planned, if it is not there yet. */
  show(plan: Plan | undefined, dark: boolean) {
    const key = plan ? JSON.stringify([plan, dark], (_, x: unknown) => (typeof x === 'number' ? x.toFixed(4) : x)) : '';
    if (key === this.made) return;
    this.made = key;
    this.clear();
    if (!plan) return;
    this.group.add(this.solid, this.ghost);
    const palette = dark ? DARK : LIGHT;
    if (plan.is === 'slab') this.slab(plan, palette);
    else this.table(plan, palette);
  }

  /** For a picture: solid, or looked through where it would hide something. */
  face(camera: Camera) {
    if (!this.front) return;
    const { plane, isOn } = this.front;
    const isBehind = plane.distanceToPoint(camera.position) < 0;
    const crossing = new Vector3();
    const hides = ARM.some((place) => {
      const hit = plane.intersectLine(new Line3(camera.position, place), crossing);
      return hit !== null && isOn(hit);
    });
    this.solid.visible = !isBehind && !hides;
    this.ghost.visible = !this.solid.visible;
  }

  private slab(plan: Slab, palette: Palette) {
    const [low, right] = plan.low;
    const [high, left] = plan.high;
    const { turn } = plan.face;
    const stand = new Matrix4().makeRotationFromQuaternion(turn);
    stand.multiply(new Matrix4().makeTranslation((low + high) / 2, (right + left) / 2, plan.front));
    const [tall, wide] = [high - low, left - right];
    const outline = rounded(tall, wide, plan.round);
    const bevel = Math.min(0.002, plan.thick / 4);
    const body = new ExtrudeGeometry(rounded(tall - 2 * bevel, wide - 2 * bevel, plan.round), {
      depth: plan.thick - 2 * bevel,
      bevelThickness: bevel,
      bevelSize: bevel,
      bevelSegments: 2,
      curveSegments: 8,
    }).translate(0, 0, -plan.thick + bevel);
    const inner = rounded(tall - 2 * plan.frame, wide - 2 * plan.frame, Math.max(0.001, plan.round - plan.frame));
    // What reaches into it is seen all the same: it leaves its depth a little behind itself.
    this.add(this.solid, body, new MeshLambertMaterial({ color: palette.body, depthWrite: false }), stand, ORDER);
    const screen = new MeshBasicMaterial({ color: palette.screen, depthWrite: false });
    this.add(this.solid, new ShapeGeometry(inner, 8).translate(0, 0, 0.0002), screen, stand, ORDER + 0.1);
    if (plan.hasLens) {
      const lens = new ShapeGeometry(rounded(0.0035, 0.0035, 0.0017), 8);
      lens.translate(tall / 2 - plan.frame - 0.005, 0, 0.0003);
      this.add(this.solid, lens, new MeshBasicMaterial({ color: palette.lens, depthWrite: false }), stand, ORDER + 0.2);
    }
    const depth = new ShapeGeometry(outline, 8).translate(0, 0, -DEEP);
    this.add(this.solid, depth, new MeshBasicMaterial({ colorWrite: false }), stand, ORDER + 0.3);
    if (plan.foot) this.feet(plan, plan.foot.floor, palette);
    this.outline(outline, stand, palette);
    const back = turn.clone().invert();
    const isOn = (place: Vector3) => {
      const { x, y } = place.clone().applyQuaternion(back);
      return x > low && x < high && y > right && y < left;
    };
    this.front = { plane: new Plane(new Vector3(0, 0, 1).applyQuaternion(turn), -plan.front), isOn };
  }

  /** Slim posts behind an upright slab, near its sides, each with a foot on the floor. */
  private feet({ face, low, high, front, thick }: Slab, floor: number, palette: Palette) {
    const inset = Math.min(0.12, (high[1] - low[1]) / 4);
    for (const y of [low[1] + inset, high[1] - inset]) {
      const middle = new Vector3(low[0], y, front - DEEP - thick - 0.01).applyQuaternion(face.turn);
      const tall = middle.z - floor - 0.012;
      const out = new Vector3(0, 0, 1).applyQuaternion(face.turn);
      const post = new CylinderGeometry(0.012, 0.012, tall, 12).rotateX(Math.PI / 2);
      const foot = new BoxGeometry(0.5, 0.03, 0.014).rotateZ(Math.atan2(out.y, out.x));
      for (const [part, up] of [
        [post, tall / 2],
        [foot, 0.007],
      ] as const) {
        part.translate(middle.x, middle.y, floor + up);
        this.add(this.group, part, new MeshLambertMaterial({ color: palette.leg }));
      }
    }
  }

  private table({ box, floor }: Table, palette: Palette) {
    const size = box.getSize(new Vector3());
    const middle = box.getCenter(new Vector3());
    const outline = rounded(size.x, size.y, 0.03);
    const stand = new Matrix4().makeTranslation(middle.x, middle.y, box.max.z);
    const top = new ExtrudeGeometry(rounded(size.x - 0.006, size.y - 0.006, 0.03), {
      depth: size.z - 0.006,
      bevelThickness: 0.003,
      bevelSize: 0.003,
      bevelSegments: 2,
      curveSegments: 8,
    }).translate(0, 0, -size.z + 0.003);
    this.add(this.solid, top, new MeshLambertMaterial({ color: palette.top }), stand);
    this.outline(outline, stand, palette);
    const tall = box.min.z - floor;
    if (tall > 0.05)
      for (const x of [box.min.x + 0.05, box.max.x - 0.05])
        for (const y of [box.min.y + 0.05, box.max.y - 0.05]) {
          const leg = new CylinderGeometry(0.018, 0.013, tall, 16).rotateX(Math.PI / 2);
          leg.translate(x, y, floor + tall / 2);
          this.add(this.group, leg, new MeshLambertMaterial({ color: palette.leg }));
        }
    const isOn = ({ x, y }: Vector3) => x > box.min.x && x < box.max.x && y > box.min.y && y < box.max.y;
    this.front = { plane: new Plane(new Vector3(0, 0, 1), -box.max.z), isOn };
  }

  /** What is left of it from behind: a pane with an edge. */
  private outline(shape: Shape, stand: Matrix4, palette: Palette) {
    const pane = { color: palette.line, transparent: true, opacity: 0.08, depthWrite: false, side: 2 } as const;
    this.add(this.ghost, new ShapeGeometry(shape, 8), new MeshBasicMaterial(pane), stand);
    const geometry = new BufferGeometry().setFromPoints(shape.getPoints(8));
    const material = new LineBasicMaterial({ color: palette.line });
    this.ghost.add(put(new LineLoop(geometry, material), stand));
    this.parts.push({ geometry, material });
  }

  private add(to: Group, geometry: BufferGeometry, material: Material, stand = new Matrix4(), order = 0) {
    const mesh = put(new Mesh(geometry, material), stand);
    mesh.renderOrder = order;
    to.add(mesh);
    this.parts.push({ geometry, material });
  }

  private clear() {
    this.parts.forEach(({ geometry, material }) => (geometry.dispose(), material.dispose()));
    this.parts = [];
    this.front = undefined;
    [this.solid, this.ghost, this.group].forEach((group) => group.clear());
  }

  dispose() {
    this.clear();
  }
}

function put<T extends Mesh | LineLoop>(mesh: T, stand: Matrix4): T {
  mesh.matrix.copy(stand);
  mesh.matrixAutoUpdate = false;
  return mesh;
}

/** A rectangle around the origin with round corners. */
function rounded(tall: number, wide: number, radius: number): Shape {
  const [x, y] = [tall / 2, wide / 2];
  const r = Math.min(radius, x, y);
  const quarter = Math.PI / 2;
  return new Shape()
    .absarc(x - r, y - r, r, 0, quarter, false)
    .absarc(r - x, y - r, r, quarter, 2 * quarter, false)
    .absarc(r - x, r - y, r, 2 * quarter, 3 * quarter, false)
    .absarc(x - r, r - y, r, 3 * quarter, 4 * quarter, false)
    .closePath() as Shape;
}
