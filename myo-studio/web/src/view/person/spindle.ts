// The form of a muscle as far as its model tells it once and for all: how strong it is and what it is fastened to.
import type { Blob } from './field';
import type { PersonShape } from './types';

/** Cross-sections of a muscle: a body with many muscles draws each with fewer. */
export const ringsPerMuscle = (muscles: number): number => (muscles > 40 ? 8 : 11);

/** radius in metres of a muscle of 1 N; the square of the radius grows with the force */
const RADIUS_PER_ROOT_NEWTON = 7.2e-4;
const USUAL_FORCE = 400;

export interface Spindle {
  /** where its numbers begin in the frame */
  offset: number;
  points: number;
  radius: number;
  /** how much wider than thick: muscles from the trunk are sheets, those of the arm are round */
  flatness: number;
  bellyFrom: number;
  bellyTo: number;
  /** of its path at the first moment, in metres */
  length: number;
  /** how far it stands aside, in radii, because others share its path */
  lane: number;
  /** how far each ring is into the belly, 0 = tendon */
  belly: Float64Array;
  /** the same for its width: on the trunk a muscle begins broad */
  breadth: Float64Array;
  /** what it lifts the skin with, if it does */
  bulge: Blob | null;
}

export type Where = 'trunk' | 'arm' | 'hand';

/** Tells of a part whether it belongs to the trunk, the arm or the hand (with its fingers). */
export function limbTest({ parts, limb }: PersonShape): (part: number) => Where {
  const hand = limb[limb.length - 1]!;
  return (part) => {
    let where: Where = 'trunk';
    // The world is its own parent, or has none: the walk ends there.
    for (let at = part; ; at = parts[at]!.parent) {
      if (at === hand) return 'hand';
      if (limb.includes(at)) where = 'arm';
      const parent = parts[at]!.parent;
      if (parent === at || parent < 0) return where;
    }
  };
}

export function spindleOf(
  muscle: PersonShape['muscles'][number],
  where: (part: number) => Where,
  offset: number,
  rings: number,
): Spindle {
  const places = muscle.on.map(where);
  const trunk = places.filter((place) => place === 'trunk').length / Math.max(1, places.length);
  const hand = places.filter((place) => place === 'hand').length / Math.max(1, places.length);
  const [bellyFrom, bellyTo] = bellyOf(places, hand);
  const belly = Float64Array.from({ length: rings }, (_, ring) => {
    const t = (ring / (rings - 1) - bellyFrom) / (bellyTo - bellyFrom);
    return t > 0 && t < 1 ? Math.sin(Math.PI * t) ** 0.85 : 0;
  });
  const breadth = belly.map((value, ring) => Math.max(value, 0.8 * broadness(places, ring / (rings - 1))));
  const force = muscle.peak_force_n ?? USUAL_FORCE;
  const radius = Math.min(0.0245, Math.max(0.004, RADIUS_PER_ROOT_NEWTON * Math.sqrt(force)));
  const flatness = 1.15 + 0.7 * trunk;
  return {
    offset,
    points: muscle.points,
    radius,
    flatness,
    bellyFrom,
    bellyTo,
    length: 0,
    lane: 0,
    belly,
    breadth,
    bulge: null,
  };
}

/** Where along the path the belly is: broad where it comes from the trunk, a tendon on the arm, all tendon on the hand. */
function bellyOf(places: readonly Where[], hand: number): [number, number] {
  const ending = (place: Where | undefined, tendon: number): number => (place === 'trunk' ? -0.05 : tendon);
  const first = places[0];
  const last = places[places.length - 1];
  const from = first === 'hand' ? Math.max(0.2, hand) : ending(first, 0.05);
  const to = last === 'hand' ? 1 - Math.max(0.2, hand) : 1 - ending(last, 0.1);
  return from < to - 0.2 ? [from, to] : [0.05, 0.55];
}

/** How wide a muscle is near an end that lies on the trunk: a rounded blade that narrows towards the middle. */
function broadness(places: readonly Where[], t: number): number {
  const blade = (far: number): number => Math.max(0, 1 - 2 * far) * Math.sqrt(1 - Math.max(0, 1 - far / 0.2) ** 2);
  const first = places[0] === 'trunk' ? blade(t) : 0;
  const last = places[places.length - 1] === 'trunk' ? blade(1 - t) : 0;
  return Math.max(first, last);
}
