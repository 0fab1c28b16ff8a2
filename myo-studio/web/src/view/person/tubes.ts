// Many tubes that change their form every moment, in one geometry: muscles, bones and fingers.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, type Vector3 } from 'three';

export const SIDES = 8;
const COS = Float64Array.from({ length: SIDES }, (_, i) => Math.cos((2 * Math.PI * i) / SIDES));
const SIN = Float64Array.from({ length: SIDES }, (_, i) => Math.sin((2 * Math.PI * i) / SIDES));

export class Tubes {
  readonly geometry = new BufferGeometry();
  private readonly position: BufferAttribute;
  private readonly normal: BufferAttribute;
  private readonly color: BufferAttribute;
  private readonly fine: BufferAttribute;
  private readonly rough: BufferAttribute;

  /** `rings`: of each tube, how many cross-sections; `always`: so many of the first tubes are never rough */
  constructor(rings: readonly number[], always: number) {
    const corners = rings.reduce((sum, count) => sum + count, 0) * SIDES;
    this.position = new BufferAttribute(new Float32Array(corners * 3), 3).setUsage(DynamicDrawUsage);
    this.normal = new BufferAttribute(new Int8Array(corners * 3), 3, true).setUsage(DynamicDrawUsage);
    this.color = new BufferAttribute(new Uint8Array(corners * 3), 3, true).setUsage(DynamicDrawUsage);
    this.geometry.setAttribute('position', this.position);
    this.geometry.setAttribute('normal', this.normal);
    this.geometry.setAttribute('color', this.color);
    this.fine = faces(rings, rings.length);
    this.rough = faces(rings, always);
    this.geometry.setIndex(this.fine);
  }

  /**
   * One elliptic cross-section: `at` its centre, `along` the tube and `out` (both of length 1, at a right angle), how
   * `wide` it is sideways and how `thin` in the direction `out`; `flare`: how fast the radius grows along the tube; `curl`:
   * how strongly the section bends around what it lies on (1 / radius of that).
   */
  ring(
    index: number,
    at: Float64Array,
    along: Float64Array,
    out: Float64Array,
    wide: number,
    thin: number,
    flare: number,
    curl: number,
  ): void {
    const position = this.position.array;
    const normal = this.normal.array;
    const ax = along[0]!;
    const ay = along[1]!;
    const az = along[2]!;
    const ox = out[0]!;
    const oy = out[1]!;
    const oz = out[2]!;
    const sx = ay * oz - az * oy;
    const sy = az * ox - ax * oz;
    const sz = ax * oy - ay * ox;
    let p = index * SIDES * 3;
    for (let i = 0; i < SIDES; i++, p += 3) {
      const side = COS[i]! * wide;
      const up = SIN[i]! * thin - 0.5 * curl * side * side;
      position[p] = at[0]! + side * sx + up * ox;
      position[p + 1] = at[1]! + side * sy + up * oy;
      position[p + 2] = at[2]! + side * sz + up * oz;
      const nu = SIN[i]! * wide;
      const ns = COS[i]! * thin + curl * side * nu;
      const steep = -flare * Math.sqrt(ns * ns + nu * nu);
      const scale = 127 / (Math.sqrt((ns * ns + nu * nu) * (1 + flare * flare)) + 1e-12);
      normal[p] = scale * (ns * sx + nu * ox + steep * ax);
      normal[p + 1] = scale * (ns * sy + nu * oy + steep * ay);
      normal[p + 2] = scale * (ns * sz + nu * oz + steep * az);
    }
  }

  /** Colours a ring; parts of 1, in the linear space three.js computes in. */
  paint(index: number, red: number, green: number, blue: number): void {
    const color = this.color.array;
    for (let i = 0, p = index * SIDES * 3; i < SIDES; i++, p += 3) {
      color[p] = red * 255;
      color[p + 1] = green * 255;
      color[p + 2] = blue * 255;
    }
  }

  /** Draws every other side alone. */
  setRough(on: boolean): void {
    this.geometry.setIndex(on ? this.rough : this.fine);
  }

  moved(): void {
    this.position.needsUpdate = true;
    this.normal.needsUpdate = true;
  }

  painted(): void {
    this.color.needsUpdate = true;
  }
}

/** The sides of all tubes; of those after the first `fine` ones half as many. */
function faces(rings: readonly number[], fine: number): BufferAttribute {
  const list: number[] = [];
  let first = 0;
  rings.forEach((count, tube) => {
    const step = tube < fine ? 1 : 2;
    for (let r = 0; r < count - 1; r++)
      for (let i = 0; i < SIDES; i += step) {
        const a = (first + r) * SIDES + i;
        const b = (first + r) * SIDES + ((i + step) % SIDES);
        list.push(a, b + SIDES, b, a, a + SIDES, b + SIDES);
      }
    first += count;
  });
  return new BufferAttribute(new Uint32Array(list), 1);
}

/** Sets `along` and any direction `out` at a right angle to it; round tubes do not mind which. */
export function aim(from: Vector3, to: Vector3, along: Float64Array, out: Float64Array): void {
  const x = to.x - from.x;
  const y = to.y - from.y;
  const z = to.z - from.z;
  const length = Math.sqrt(x * x + y * y + z * z) + 1e-9;
  along[0] = x / length;
  along[1] = y / length;
  along[2] = z / length;
  const level = Math.hypot(x, y);
  if (level < 1e-4 * length) {
    out[0] = 1;
    out[1] = 0;
    out[2] = 0;
    return;
  }
  out[0] = (-along[2] * x) / level;
  out[1] = (-along[2] * y) / level;
  out[2] = level / length;
}
