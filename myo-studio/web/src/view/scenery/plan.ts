import { Box3, Vector3 } from 'three';
import type { ObjectView } from '../../engine/protocol';
import { MIDDLE, floorHeight } from '../person/figure';
import type { Choice } from './choice';
import { bounds, face } from './place';
import type { Face } from './place';

/** A slab with a screen, in the axes of the face that it lies behind (m). */
export interface Slab {
  is: 'slab';
  face: Face;
  /** Its edges: along x from the lower to the upper one, along y from right to left. */
  low: [number, number];
  high: [number, number];
  /** Its front, out of the face. */
  front: number;
  thick: number;
  round: number;
  /** Width of the frame around the screen. */
  frame: number;
  /** Where it stands on the floor, if it does (m, world): its foot. */
  foot?: { floor: number } | undefined;
  hasLens: boolean;
}

/** A top with legs, in the axes of the world (m). */
export interface Table {
  is: 'table';
  box: Box3;
  floor: number;
}

export type Plan = Slab | Table;

/** So far is it from the objects (m). */
const GAP = 0.002;

/** What the scenery measures, for people: width and height of a slab, height of a table above the floor. */
export function words(plan: Plan): string {
  const cm = (m: number) => (100 * m).toFixed(m < 0.1 ? 1 : 0);
  if (plan.is === 'table') return `${cm(plan.box.max.z - plan.floor)} cm high`;
  const [wide, high] = [plan.high[1] - plan.low[1], plan.high[0] - plan.low[0]];
  const isTooLarge = plan.hasLens && wide > 0.11;
  return `${cm(wide)} × ${cm(high)} cm${isTooLarge ? ', larger than phones are' : ''}`;
}

/** What is to be built for objects, as large as they need. */
export function plan({ thing, sitting }: Choice, objects: ObjectView[]): Plan | undefined {
  const found = thing === 'none' ? undefined : face(objects);
  if (!found) return undefined;
  if (thing === 'table') return table(objects, floorHeight(sitting));
  const slab = { phone, tablet, wall }[thing as 'phone' | 'tablet' | 'wall'](found);
  return thing === 'wall' ? standing(slab, floorHeight(sitting)) : slab;
}

function phone(face: Face): Slab {
  const { min, max } = face.bounds;
  const wide = Math.max(0.071, max.y - min.y + 0.01);
  const high = Math.max(2.05 * wide, max.x - min.x + 0.03);
  // Keys are at the bottom of a phone, and what is as high as wide in its middle.
  const left = high - (max.x - min.x) - 0.03;
  const isFlat = max.x - min.x < 0.7 * (max.y - min.y);
  const low = min.x - 0.015 - left * (isFlat ? 0.08 : 0.5);
  return { ...slab(face, low, high, wide), thick: 0.008, round: 0.15 * wide, frame: 0.003, hasLens: true };
}

function tablet(face: Face): Slab {
  const { min, max } = face.bounds;
  const [needHigh, needWide] = [max.x - min.x + 0.04, max.y - min.y + 0.04];
  const isUpright = needHigh > needWide;
  const wide = Math.max(isUpright ? 0.178 : 0.25, needWide, isUpright ? needHigh / 1.4 : 0);
  const high = Math.max(isUpright ? 0.25 : 0.178, needHigh, isUpright ? 0 : needWide / 1.4);
  const low = (min.x + max.x - high) / 2;
  return { ...slab(face, low, high, wide), thick: 0.008, round: 0.013, frame: 0.009, hasLens: false };
}

function wall(face: Face): Slab {
  const { min, max } = face.bounds;
  const wide = Math.max(0.95, max.y - min.y + 0.35);
  const high = Math.max(0.56, max.x - min.x + 0.2);
  const low = (min.x + max.x - high) / 2;
  return { ...slab(face, low, high, wide), thick: 0.016, round: 0.008, frame: 0.008, hasLens: false };
}

function slab(face: Face, low: number, high: number, wide: number): Slab {
  const { min, max } = face.bounds;
  const right = (min.y + max.y - wide) / 2;
  return {
    is: 'slab',
    face,
    low: [low, right],
    high: [low + high, right + wide],
    front: min.z - GAP,
    thick: 0.01,
    round: 0.01,
    frame: 0.01,
    hasLens: false,
  };
}

/** An upright one stands on the floor: on a foot, or itself where it comes down so far. */
function standing(slab: Slab, floor: number): Slab {
  const up = new Vector3(1, 0, 0).applyQuaternion(slab.face.turn);
  if (up.z < 0.95) return slab;
  const low = slab.low[0] * up.z;
  if (low - floor < 0.3) return { ...slab, low: [floor / up.z, slab.low[1]] };
  return { ...slab, foot: { floor } };
}

function table(objects: ObjectView[], floor: number): Table {
  const { min, max } = bounds(objects.filter(({ kind }) => kind !== 'obstacle'));
  const top = min.z - GAP;
  // Before the belly; what is lower than the thighs of somebody who sits begins beyond the knees.
  const near = Math.min(0.2, min.x - 0.06);
  const box = new Box3(
    new Vector3(near, Math.min(MIDDLE - 0.55, min.y - 0.12), top - 0.024),
    new Vector3(Math.max(near + 0.6, max.x + 0.1), Math.max(MIDDLE + 0.55, max.y + 0.12), top),
  );
  return { is: 'table', box, floor };
}
