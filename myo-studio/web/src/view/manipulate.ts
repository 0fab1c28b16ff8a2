import { Group, Matrix4, Object3D, Plane, Quaternion, Raycaster, Vector2, Vector3 } from 'three';
import { TransformControls } from 'three/examples/jsm/controls/TransformControls.js';
import type { ItemView } from '../engine/protocol';
import type { Objects } from './objects';
import type { Stage } from './stage';

export type Tool = 'move' | 'turn' | 'size';

const UP = new Vector3(0, 0, 1);

/** Steps that a drag keeps to: half a centimetre, five degrees. */
export const SNAP_M = 0.005;
export const SNAP_DEG = 5;

/** What a drag asks for. */
export interface Change {
  /** By how much it moves (m), in world axes: x forward, y to the left, z up. */
  way?: [number, number, number];
  tilt_deg?: number;
  turn_deg?: number;
  /** Factors along its own axes: up the face, across it, out of it. */
  size?: [number, number, number];
}

export interface Hands {
  /** Something was pointed at; nothing where it is empty. */
  pick(object: number | undefined, add: boolean): void;
  begin(): void;
  change(item: ItemView, change: Change): void;
  end(): void;
}

/** Takes hold of objects: directly, in the plane that faces the camera, or by the handles of what is selected. */
export class Manipulator {
  private readonly gizmo: TransformControls;
  private readonly proxy = new Object3D();
  private item: ItemView | undefined;
  private start = { position: new Vector3(), scale: new Vector3(), tilt: 0 };
  private grip: { plane: Plane; from: Vector3; told: Vector3; moved: boolean; object: number } | undefined;
  private readonly ray = new Raycaster();
  snap = true;

  constructor(
    private readonly stage: Stage,
    private readonly canvas: HTMLCanvasElement,
    private readonly objects: Objects,
    private readonly itemOf: (object: number) => ItemView | undefined,
    private readonly hands: Hands,
  ) {
    this.gizmo = new TransformControls(stage.camera, canvas);
    this.gizmo.setSize(0.75);
    const helper = this.gizmo.getHelper();
    stage.scene.add(this.proxy, helper as unknown as Group);
    this.gizmo.addEventListener('change', () => stage.draw());
    this.gizmo.addEventListener('dragging-changed', ({ value }) => this.hold(Boolean(value)));
    this.gizmo.addEventListener('objectChange', () => this.pulled());
    canvas.addEventListener('pointerdown', this.down);
    canvas.addEventListener('pointermove', this.move);
    canvas.addEventListener('pointerup', this.up);
    canvas.addEventListener('pointercancel', this.up);
    this.use('move');
  }

  use(tool: Tool) {
    this.gizmo.setMode(({ move: 'translate', turn: 'rotate', size: 'scale' } as const)[tool]);
    this.gizmo.setSpace('local');
    // A face is tilted and turned; it never rolls.
    this.gizmo.showX = tool !== 'turn';
    this.setSnap(this.snap);
    this.stage.draw();
  }

  setSnap(on: boolean) {
    this.snap = on;
    this.gizmo.setTranslationSnap(on ? SNAP_M : null);
    this.gizmo.setRotationSnap(on ? (SNAP_DEG * Math.PI) / 180 : null);
    this.gizmo.setScaleSnap(on ? 0.05 : null);
  }

  /** Shows handles at an item; at none without one. While it is dragged they stay in the hand. */
  select(item: ItemView | undefined) {
    this.item = item;
    if (this.gizmo.dragging) return;
    if (!item) {
      this.gizmo.detach();
      this.stage.draw();
      return;
    }
    this.proxy.position.set(...item.at);
    this.proxy.quaternion.copy(this.axes(item));
    this.proxy.scale.set(1, 1, 1);
    this.gizmo.attach(this.proxy);
    this.stage.draw();
  }

  /** How the handles lie: places are written along the axes around an item, and sizes along its own. */
  private axes(item: ItemView): Quaternion {
    const around = new Quaternion(...item.parent_rotation);
    if (this.gizmo.mode === 'translate') return around;
    if (this.gizmo.mode === 'scale') return new Quaternion(...item.rotation);
    // One ring turns about the upright axis around it, the other tilts about the level axis that is turned with it.
    return around.multiply(new Quaternion().setFromAxisAngle(UP, angles(item, new Quaternion(...item.rotation)).turn));
  }

  /** Leaves the handles out of a picture. */
  hide(on: boolean) {
    this.gizmo.getHelper().visible = !on && this.gizmo.object !== undefined;
  }

  private hold(on: boolean) {
    this.stage.controls.enabled = !on;
    if (on) {
      this.remember();
      this.hands.begin();
    } else {
      this.hands.end();
      this.select(this.item);
    }
  }

  private remember() {
    this.start.position.copy(this.proxy.position);
    this.start.scale.copy(this.proxy.scale);
    // A face is `Rz(turn) Ry(-tilt)`, and the handles are turned with it but not tilted.
    if (this.item) this.start.tilt = -angles(this.item, new Quaternion(...this.item.rotation)).about;
  }

  private pulled() {
    const { item, proxy, start } = this;
    if (!item) return;
    if (this.gizmo.mode === 'translate') {
      const way = proxy.position.clone().sub(start.position);
      start.position.copy(proxy.position);
      this.hands.change(item, { way: way.toArray() });
    } else if (this.gizmo.mode === 'rotate') {
      const { turn, about } = angles(item, proxy.quaternion);
      const tilt = Math.min(Math.PI, Math.max(0, start.tilt - about));
      this.hands.change(item, { tilt_deg: degrees(tilt), turn_deg: degrees(turn) });
    } else {
      const size: [number, number, number] = [0, 1, 2].map(
        (axis) => proxy.scale.getComponent(axis) / start.scale.getComponent(axis),
      ) as never;
      start.scale.copy(proxy.scale);
      this.hands.change(item, { size });
    }
  }

  private aim(event: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.ray.setFromCamera(new Vector2(x, y), this.stage.camera);
  }

  private down = (event: PointerEvent) => {
    if (event.button !== 0 || this.gizmo.dragging || this.gizmo.axis !== null) return;
    this.aim(event);
    const hit = this.objects.hit(this.ray);
    this.hands.pick(hit?.object, event.shiftKey);
    if (!hit) return;
    this.stage.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    const plane = new Plane().setFromNormalAndCoplanarPoint(
      facing(this.stage.camera.getWorldDirection(new Vector3())),
      hit.point,
    );
    this.grip = { plane, from: hit.point.clone(), told: new Vector3(), moved: false, object: hit.object };
  };

  private move = (event: PointerEvent) => {
    const { grip } = this;
    if (!grip) {
      this.aim(event);
      const over = this.objects.hit(this.ray) !== undefined;
      this.canvas.style.cursor = over ? 'grab' : '';
      return;
    }
    this.aim(event);
    const point = this.ray.ray.intersectPlane(grip.plane, new Vector3());
    const item = this.itemOf(grip.object);
    if (!point || !item) return;
    const way = point.sub(grip.from);
    if (this.snap) way.divideScalar(SNAP_M).round().multiplyScalar(SNAP_M);
    const step = way.clone().sub(grip.told);
    if (step.lengthSq() === 0) return;
    if (!grip.moved) this.hands.begin();
    grip.moved = true;
    grip.told.copy(way);
    this.hands.change(item, { way: step.toArray() });
  };

  private up = () => {
    if (!this.grip) return;
    if (this.grip.moved) this.hands.end();
    this.grip = undefined;
    this.stage.controls.enabled = true;
  };

  dispose() {
    this.gizmo.dispose();
    this.canvas.removeEventListener('pointerdown', this.down);
    this.canvas.removeEventListener('pointermove', this.move);
    this.canvas.removeEventListener('pointerup', this.up);
    this.canvas.removeEventListener('pointercancel', this.up);
  }
}

/** The axis of the world that looks most along the camera: a drag stays in the plane across it. */
function facing(direction: Vector3): Vector3 {
  const sizes = [Math.abs(direction.x), Math.abs(direction.y), Math.abs(direction.z)];
  return new Vector3().setComponent(sizes.indexOf(Math.max(...sizes)), 1);
}

/** A rotation in the axes around an item as `Rz(turn) Ry(about)` (rad). */
function angles(item: ItemView, world: Quaternion): { turn: number; about: number } {
  const own = new Quaternion(...item.parent_rotation).invert().multiply(world);
  const axes = new Matrix4().makeRotationFromQuaternion(own);
  const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
  axes.extractBasis(x, y, z);
  // `y` stays level: it is turned alone.
  return { turn: Math.atan2(-y.x, y.y), about: Math.atan2(-x.z, z.z) };
}

function degrees(angle: number): number {
  return Math.round((angle * 18000) / Math.PI) / 100;
}
