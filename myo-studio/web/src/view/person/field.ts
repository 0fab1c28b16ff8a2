// Soft clay: a body is a list of tapered capsules ("blobs") that melt into each other. The field is negative inside,
// zero on the surface and grows outside; it is not an exact distance, so users of it step with care.
import type { Vec } from './types';

export class Blob {
  ax = 0;
  ay = 0;
  az = 0;
  bx = 0;
  by = 0;
  bz = 0;
  inverse = 0;

  /** `melt`: over which distance the blob flows into what came before; `carve`: takes clay away instead of adding it */
  constructor(
    a: Vec,
    b: Vec,
    public ra: number,
    public rb: number,
    public melt: number,
    readonly carve = false,
  ) {
    this.place(a[0], a[1], a[2], b[0], b[1], b[2]);
  }

  place(ax: number, ay: number, az: number, bx: number, by: number, bz: number): void {
    this.ax = ax;
    this.ay = ay;
    this.az = az;
    this.bx = bx - ax;
    this.by = by - ay;
    this.bz = bz - az;
    const square = this.bx * this.bx + this.by * this.by + this.bz * this.bz;
    this.inverse = square > 1e-12 ? 1 / square : 0;
  }

  distance(x: number, y: number, z: number): number {
    const px = x - this.ax;
    const py = y - this.ay;
    const pz = z - this.az;
    const h = Math.min(1, Math.max(0, (px * this.bx + py * this.by + pz * this.bz) * this.inverse));
    const dx = px - h * this.bx;
    const dy = py - h * this.by;
    const dz = pz - h * this.bz;
    return Math.sqrt(dx * dx + dy * dy + dz * dz) - this.ra - h * (this.rb - this.ra);
  }
}

/** The mirror image of a blob across the body's mid-plane. */
export function mirrored(blob: Blob, midY: number): Blob {
  const { ax, ay, az, bx, by, bz } = blob;
  const flip = (y: number): number => 2 * midY - y;
  return new Blob([ax, flip(ay), az], [ax + bx, flip(ay + by), az + bz], blob.ra, blob.rb, blob.melt, blob.carve);
}

/** Copies to `near` the blobs that can matter within `reach` of a place; returns how many these are. */
export function gather(
  blobs: readonly Blob[],
  x: number,
  y: number,
  z: number,
  reach: number,
  near: (Blob | undefined)[],
): number {
  let count = 0;
  for (let i = 0; i < blobs.length; i++) {
    const blob = blobs[i]!;
    if (blob.distance(x, y, z) < reach + blob.melt) near[count++] = blob;
  }
  return count;
}

/** `count`: only so many blobs of the list are meant */
export function field(
  blobs: readonly (Blob | undefined)[],
  x: number,
  y: number,
  z: number,
  count = blobs.length,
): number {
  let sum = 1;
  for (let i = 0; i < count; i++) {
    const blob = blobs[i]!;
    const d = blob.distance(x, y, z);
    const k = blob.melt;
    if (blob.carve) {
      const h = Math.max(k - Math.abs(sum + d), 0);
      sum = Math.max(sum, -d) + (h * h) / (4 * k);
    } else {
      const h = Math.max(k - Math.abs(sum - d), 0);
      sum = Math.min(sum, d) - (h * h) / (4 * k);
    }
  }
  return sum;
}

const STEP = 0.001;

/** Writes the direction in which the field grows (its length is the slope) to `out`. */
export function slope(
  blobs: readonly (Blob | undefined)[],
  x: number,
  y: number,
  z: number,
  out: Float64Array,
  count = blobs.length,
): void {
  out[0] = (field(blobs, x + STEP, y, z, count) - field(blobs, x - STEP, y, z, count)) / (2 * STEP);
  out[1] = (field(blobs, x, y + STEP, z, count) - field(blobs, x, y - STEP, z, count)) / (2 * STEP);
  out[2] = (field(blobs, x, y, z + STEP, count) - field(blobs, x, y, z - STEP, count)) / (2 * STEP);
}
