// The muscles: spindles along the model's straight paths. A path is rounded, lifted off the bones and the chest, kept
// under the skin, and given a belly that keeps its volume: it thickens as it shortens, and a little more as it works.
import { Blob, field, gather, slope } from './field';
import type { Palette } from './palette';
import { type Spindle, type Where, limbTest, ringsPerMuscle, spindleOf } from './spindle';
import type { Tubes } from './tubes';
import type { PersonShape } from './types';

const ROUNDING = 2;
/** deeper than this below the clay a muscle stays where it is: hidden, as it is in a body */
const DEEP = 0.05;
/** higher than this over the skin it stays too: it belongs to a hand, which the skin does not cover */
const HIGH = 0.03;
/** muscles bend around what they lie on, about as round as an arm: 1 / metres */
const CURL = 13;
/** thickness of the skin over a muscle */
const COVER = 0.004;
/** so many muscles of the arm show as bulges of the skin */
const BULGES = 9;
/** muscles nearer than this share a path, and then lie this many radii apart */
const SAME_PATH = 0.016;
const LANE = 0.9;
/** how much a ring keeps the direction of the ring before it */
const MEMORY = 2.5;
/** clay farther from a muscle than this does not concern it */
const AROUND = 0.04;

/** What muscles lie on, and what covers them. */
export interface Clay {
  readonly core: readonly Blob[];
  readonly skin: readonly Blob[];
}

export class Muscles {
  readonly bulges: Blob[];
  private readonly spindles: Spindle[];
  private readonly activation: Float64Array;
  private settled = false;
  private readonly rings: number;
  private readonly last: number;
  private readonly path: Float64Array;
  /** the blobs that matter for the muscle in work */
  private readonly core: (Blob | undefined)[] = [];
  private readonly skin: (Blob | undefined)[] = [];
  private cores = 0;
  private skins = 0;
  private readonly at = new Float64Array(3);
  private readonly along = new Float64Array(3);
  private readonly out = new Float64Array(3);
  private readonly middleOut = new Float64Array(3);
  /** of the muscle in work: half its thickness, half its width, the radius of its tendon, how far it steps aside */
  private thin = 0;
  private broad = 0;
  private tendon = 0;
  private aside = 0;

  /** `firstRing`: where in `tubes` the muscles begin */
  constructor(
    shape: PersonShape,
    private readonly tubes: Tubes,
    private readonly firstRing: number,
    onLimb: (part: number) => Where = limbTest(shape),
  ) {
    this.rings = ringsPerMuscle(shape.muscles.length);
    this.last = this.rings - 1;
    this.path = new Float64Array(this.rings * 3);
    let offset = 0;
    this.spindles = shape.muscles.map((muscle) => {
      const spindle = spindleOf(muscle, onLimb, offset, this.rings);
      offset += muscle.points * 3 + 1;
      return spindle;
    });
    this.activation = new Float64Array(shape.muscles.length);
    this.bulges = this.chooseBulges(shape, onLimb);
  }

  /** The strongest muscles that reach the arm. */
  private chooseBulges(shape: PersonShape, where: (part: number) => Where): Blob[] {
    const onArm = this.spindles.filter((_, i) => shape.muscles[i]!.on.some((part) => where(part) === 'arm'));
    const strongest = onArm.sort((a, b) => b.radius - a.radius).slice(0, BULGES);
    return strongest.map((spindle) => (spindle.bulge = new Blob([0, 0, 0], [0, 0, 0], 0, 0, 0.03)));
  }

  update(numbers: Float32Array, limb: Clay, colors: Palette): void {
    if (!this.settled) this.settleLanes(numbers);
    for (let i = 0; i < this.spindles.length; i++) {
      const spindle = this.spindles[i]!;
      const length = this.layPath(numbers, spindle);
      this.activation[i] = numbers[spindle.offset + spindle.points * 3]!;
      const work = this.activation[i]!;
      const swell = Math.sqrt(spindle.length / (length + 1e-6)) * (0.97 + 0.13 * work);
      const radius = spindle.radius * Math.min(1.35, Math.max(0.8, swell));
      this.layTube(spindle, this.firstRing + i * this.rings, radius, length, limb);
    }
    this.paint(colors);
  }

  /** The first moment shows how long the muscles are, and which of them run along the same path: these step aside. */
  private settleLanes(numbers: Float32Array): void {
    const middles = this.spindles.map((spindle) => {
      spindle.length = this.layPath(numbers, spindle);
      const third = Math.round(this.rings / 3);
      return this.path.slice(third * 3, (this.rings - third) * 3);
    });
    const groups: number[][] = [];
    middles.forEach((middle, i) => {
      const group = groups.find((members) => members.some((j) => apart(middle, middles[j]!) < SAME_PATH));
      if (group) group.push(i);
      else groups.push([i]);
    });
    for (const group of groups)
      group.forEach((i, place) => (this.spindles[i]!.lane = LANE * (place - (group.length - 1) / 2)));
    this.settled = true;
  }

  private stepAside(far: number): void {
    const { at, along: a, out: o } = this;
    at[0]! += far * (a[1]! * o[2]! - a[2]! * o[1]!);
    at[1]! += far * (a[2]! * o[0]! - a[0]! * o[2]!);
    at[2]! += far * (a[0]! * o[1]! - a[1]! * o[0]!);
  }

  paint(colors: Palette): void {
    const { tendon, rest, active } = colors;
    for (let i = 0; i < this.spindles.length; i++) {
      const { belly } = this.spindles[i]!;
      const work = Math.min(1, Math.max(0, this.activation[i]!));
      const red = rest.r + work * (active.r - rest.r);
      const green = rest.g + work * (active.g - rest.g);
      const blue = rest.b + work * (active.b - rest.b);
      for (let ring = 0; ring < this.rings; ring++) {
        const flesh = Math.min(1, 1.5 * belly[ring]! ** 1.4);
        this.tubes.paint(
          this.firstRing + i * this.rings + ring,
          tendon.r + flesh * (red - tendon.r),
          tendon.g + flesh * (green - tendon.g),
          tendon.b + flesh * (blue - tendon.b),
        );
      }
    }
    this.tubes.painted();
  }

  /** Writes evenly spaced, rounded places along the model's path to `path`; returns the length of the model's path. */
  private layPath(numbers: Float32Array, { offset, points }: Spindle): number {
    const path = this.path;
    let length = 0;
    for (let k = 1; k < points; k++) length += gap(numbers, offset + k * 3);
    let k = 1;
    let start = 0;
    let piece = gap(numbers, offset + 3);
    for (let ring = 0; ring < this.rings; ring++) {
      const goal = (length * ring) / this.last;
      while (k < points - 1 && goal > start + piece) {
        start += piece;
        piece = gap(numbers, offset + ++k * 3);
      }
      const t = Math.min(1, (goal - start) / (piece + 1e-9));
      const p = offset + k * 3;
      for (let axis = 0; axis < 3; axis++)
        path[ring * 3 + axis] = numbers[p - 3 + axis]! + t * (numbers[p + axis]! - numbers[p - 3 + axis]!);
    }
    for (let pass = 0; pass < ROUNDING; pass++) this.round();
    return length;
  }

  /** The ends stay exactly where they are. */
  private round(): void {
    const path = this.path;
    for (let p = 3; p < this.last * 3; p++) path[p] = 0.25 * path[p - 3]! + 0.5 * path[p]! + 0.25 * path[p + 3]!;
  }

  private layTube(spindle: Spindle, first: number, radius: number, length: number, limb: Clay): void {
    // Short muscles are patches: as wide as their force asks, but not thicker than their length allows.
    this.thin = Math.min(radius / spindle.flatness, 0.12 * spindle.length);
    this.broad = Math.min(radius * spindle.flatness, 0.19 * spindle.length);
    this.tendon = Math.min(0.0032, 0.3 * radius, this.thin);
    this.aside = spindle.lane * radius;
    this.gatherBlobs(limb, length);
    for (let pass = 0; pass < 2; pass++) {
      for (let ring = 1; ring < this.last; ring++) this.settle(ring, this.thin, spindle.belly[ring]!);
      this.round();
    }
    // From the middle, which lies free, to the ends, which may lie deep in bone or chest where "out" means little.
    const middle = this.last >> 1;
    this.out.fill(0);
    for (let ring = middle; ring <= this.last; ring++) {
      this.layRing(spindle, first, ring);
      if (ring === middle) this.middleOut.set(this.out);
    }
    this.out.set(this.middleOut);
    for (let ring = middle - 1; ring >= 0; ring--) this.layRing(spindle, first, ring);
    if (spindle.bulge) this.swell(spindle, spindle.bulge, this.thin);
  }

  private layRing({ belly, breadth }: Spindle, first: number, ring: number): void {
    const { path, thin, tendon } = this;
    for (let axis = 0; axis < 3; axis++) this.at[axis] = path[ring * 3 + axis]!;
    this.direct(ring);
    this.stepAside(this.aside * belly[ring]!);
    const before = Math.max(0, ring - 1);
    const after = Math.min(this.last, ring + 1);
    const flare = ((thin - tendon) * (belly[after]! - belly[before]!)) / (distance(path, before * 3, after * 3) + 1e-6);
    // The ends are closed to an edge: a sheet then sinks into the clay instead of ending in a stump.
    const end = ring === 0 || ring === this.last;
    const wide = (tendon + (this.broad - tendon) * breadth[ring]!) * (end ? 0.6 : 1);
    const thick = (tendon + (thin - tendon) * belly[ring]!) * (end ? 0.2 : 1);
    this.tubes.ring(first + ring, this.at, this.along, this.out, wide, thick, flare, CURL);
  }

  /** A path lies within half its length of its middle. */
  private gatherBlobs(limb: Clay, length: number): void {
    const { path } = this;
    const x = 0.5 * (path[0]! + path[this.last * 3]!);
    const y = 0.5 * (path[1]! + path[this.last * 3 + 1]!);
    const z = 0.5 * (path[2]! + path[this.last * 3 + 2]!);
    this.cores = gather(limb.core, x, y, z, 0.5 * length + AROUND, this.core);
    this.skins = gather(limb.skin, x, y, z, 0.5 * length + AROUND, this.skin);
  }

  /** Puts the spindle's bulge under the skin where its belly is. */
  private swell({ bellyFrom, bellyTo }: Spindle, bulge: Blob, thin: number): void {
    const { path } = this;
    const middle = 0.5 * (bellyFrom + bellyTo);
    const a = 3 * Math.round(this.last * (middle - 0.18));
    const b = 3 * Math.round(this.last * (middle + 0.18));
    bulge.place(path[a]!, path[a + 1]!, path[a + 2]!, path[b]!, path[b + 1]!, path[b + 2]!);
    bulge.ra = bulge.rb = 1.25 * thin + COVER;
  }

  /** Lifts a place of the path above bone and chest (the ends of the belly sink into them), or presses it under the skin. */
  private settle(ring: number, thin: number, belly: number): void {
    const { path, out } = this;
    const p = ring * 3;
    const x = path[p]!;
    const y = path[p + 1]!;
    const z = path[p + 2]!;
    const buried = thin * (1.8 * belly - 1.3) - field(this.core, x, y, z, this.cores);
    const raised = field(this.skin, x, y, z, this.skins) + thin * (0.3 + 0.7 * belly) + COVER;
    if (buried <= 0 && raised <= 0) return;
    slope(this.core, x, y, z, out, this.cores);
    const steepness = out[0]! * out[0]! + out[1]! * out[1]! + out[2]! * out[2]! + 0.1;
    const move = buried > 0 ? buried * fade(buried / DEEP) : -raised * fade(raised / HIGH);
    for (let axis = 0; axis < 3; axis++) path[p + axis]! += (move * out[axis]!) / steepness;
  }

  /** Sets `along` and `out` for a ring: `out` points away from bone and chest, and turns only slowly from ring to ring. */
  private direct(ring: number): void {
    const { path, along, at } = this;
    const before = Math.max(0, ring - 1) * 3;
    const after = Math.min(this.last, ring + 1) * 3;
    for (let axis = 0; axis < 3; axis++) along[axis] = path[after + axis]! - path[before + axis]!;
    unit(along);
    const { out } = this;
    const ox = out[0]!;
    const oy = out[1]!;
    const oz = out[2]!;
    slope(this.core, at[0]!, at[1]!, at[2]!, out, this.cores);
    out[0]! += MEMORY * ox;
    out[1]! += MEMORY * oy;
    out[2]! += MEMORY * oz;
    const lean = out[0]! * along[0]! + out[1]! * along[1]! + out[2]! * along[2]!;
    for (let axis = 0; axis < 3; axis++) out[axis]! -= lean * along[axis]!;
    // Where nothing is to lie on, any direction across will do.
    if (out[0]! * out[0]! + out[1]! * out[1]! + out[2]! * out[2]! < 1e-12) {
      const level = Math.abs(along[2]!) < 0.9;
      out[0] = level ? -along[1]! : 0;
      out[1] = level ? along[0]! : -along[2]!;
      out[2] = level ? 0 : along[1]!;
    }
    unit(out);
  }
}

/** 1 up to 1, then falling to 0 at 2. */
const fade = (t: number): number => Math.min(1, Math.max(0, 2 - t));

function gap(numbers: Float32Array, p: number): number {
  return Math.hypot(
    numbers[p]! - numbers[p - 3]!,
    numbers[p + 1]! - numbers[p - 2]!,
    numbers[p + 2]! - numbers[p - 1]!,
  );
}

function distance(path: Float64Array, a: number, b: number): number {
  return Math.hypot(path[b]! - path[a]!, path[b + 1]! - path[a + 1]!, path[b + 2]! - path[a + 2]!);
}

/** Mean distance of two rows of places. */
function apart(a: Float64Array, b: Float64Array): number {
  let sum = 0;
  for (let p = 0; p < a.length; p += 3) sum += Math.hypot(a[p]! - b[p]!, a[p + 1]! - b[p + 1]!, a[p + 2]! - b[p + 2]!);
  return (3 * sum) / a.length;
}

function unit(v: Float64Array): void {
  const scale = 1 / (Math.sqrt(v[0]! * v[0]! + v[1]! * v[1]! + v[2]! * v[2]!) + 1e-9);
  v[0]! *= scale;
  v[1]! *= scale;
  v[2]! *= scale;
}
