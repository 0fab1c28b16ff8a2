import { Box3, Matrix4, Quaternion, Vector3 } from 'three';
import type { ObjectView } from '../../engine/protocol';

/** A plane that objects face: its axes (x up it, y across it to the left, z out of it), and how far they go along these. */
export interface Face {
  turn: Quaternion;
  /** In these axes (m). */
  bounds: Box3;
}

/** Upright before the user. */
const UPRIGHT = new Quaternion().setFromRotationMatrix(
  new Matrix4().makeBasis(new Vector3(0, 0, 1), new Vector3(0, 1, 0), new Vector3(-1, 0, 0)),
);

export function face(objects: ObjectView[]): Face | undefined {
  const asked = objects.filter(({ kind }) => kind !== 'obstacle');
  const own = asked.length > 0 ? asked : objects;
  if (own.length === 0) return undefined;
  const turn = facing(own);
  return { turn, bounds: bounds(own, turn) };
}

/** How far objects go along axes, wherever they are drawn. */
export function bounds(objects: ObjectView[], turn = new Quaternion()): Box3 {
  const back = turn.clone().invert();
  const box = new Box3();
  for (const object of objects) {
    const at = new Vector3(...object.at).applyQuaternion(back);
    const far = new Vector3();
    for (const way of ways(object)) {
      way.applyQuaternion(back);
      far.add(way.set(Math.abs(way.x), Math.abs(way.y), Math.abs(way.z)));
    }
    box.expandByPoint(at.clone().add(far)).expandByPoint(at.sub(far));
    if (object.hinge) box.expandByPoint(new Vector3(...object.hinge).applyQuaternion(back));
  }
  return box;
}

/** From the middle of an object to its sides, and to the ends of the range of its place. */
function ways({ rotation, half_size, drawn }: ObjectView): Vector3[] {
  const own = new Quaternion(...rotation);
  const sides = half_size.map((size, axis) => new Vector3().setComponent(axis, size).applyQuaternion(own));
  return [...sides, ...drawn.map((way) => new Vector3(...way).divideScalar(2))];
}

/** The most common rotation of what has a face; balls have none, and lie in the plane in which they spread. */
function facing(objects: ObjectView[]): Quaternion {
  const faced = objects.filter(({ kind }) => kind !== 'sphere');
  if (faced.length > 0) return common(faced);
  const turn = common(objects);
  const size = bounds(objects).getSize(new Vector3());
  const isPlain = Math.abs(turn.w) > 0.999;
  return isPlain && size.x < size.z ? UPRIGHT.clone() : turn;
}

function common(objects: ObjectView[]): Quaternion {
  const count = new Map<string, number>();
  const name = ({ rotation }: ObjectView) => {
    // A quaternion and its negative are one rotation.
    const sign = rotation.find((part) => Math.abs(part) > 1e-3)! < 0 ? -1 : 1;
    return rotation.map((part) => (sign * part).toFixed(2)).join();
  };
  objects.forEach((object) => count.set(name(object), (count.get(name(object)) ?? 0) + 1));
  const most = [...count.entries()].reduce((best, next) => (next[1] > best[1] ? next : best))[0];
  return new Quaternion(...objects.find((object) => name(object) === most)!.rotation);
}
