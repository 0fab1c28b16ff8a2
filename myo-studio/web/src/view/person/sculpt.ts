// Turns soft clay into triangles once, at the start: surface nets on a grid, then every corner is moved exactly onto
// the surface and takes its normal from the field. That way regions of different fineness meet without visible seams.
// The field also tells how open the space before each corner is: that is the soft shade in armpits and under the chin.
import { BufferAttribute, BufferGeometry } from 'three';
import { type Blob, field, slope } from './field';
import type { Vec } from './types';

export interface Region {
  low: Vec;
  high: Vec;
  cell: number;
}

interface Mesh {
  positions: number[];
  normals: number[];
  shades: number[];
  faces: number[];
}

export function sculpt(blobs: readonly Blob[], regions: readonly Region[]): BufferGeometry {
  const mesh: Mesh = { positions: [], normals: [], shades: [], faces: [] };
  for (const region of regions) sculptRegion(blobs, region, mesh);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(mesh.positions), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(mesh.normals), 3));
  geometry.setAttribute('color', new BufferAttribute(new Uint8Array(mesh.shades), 3, true));
  geometry.setIndex(mesh.faces);
  return geometry;
}

function sculptRegion(blobs: readonly Blob[], { low, high, cell }: Region, mesh: Mesh): void {
  const nx = Math.ceil((high[0] - low[0]) / cell) + 1;
  const ny = Math.ceil((high[1] - low[1]) / cell) + 1;
  const nz = Math.ceil((high[2] - low[2]) / cell) + 1;
  const strides = [1, nx, nx * ny] as const;
  const values = new Float32Array(nx * ny * nz);
  for (let k = 0, at = 0; k < nz; k++)
    for (let j = 0; j < ny; j++)
      for (let i = 0; i < nx; i++, at++)
        values[at] = field(blobs, low[0] + i * cell, low[1] + j * cell, low[2] + k * cell);

  const corner = new Int32Array(values.length).fill(-1);
  for (let k = 0; k < nz - 1; k++)
    for (let j = 0; j < ny - 1; j++)
      for (let i = 0; i < nx - 1; i++) {
        const at = i + nx * (j + ny * k);
        const middle = crossing(values, at, strides);
        if (!middle) continue;
        corner[at] = mesh.positions.length / 3;
        addCorner(
          blobs,
          low[0] + (i + middle[0]) * cell,
          low[1] + (j + middle[1]) * cell,
          low[2] + (k + middle[2]) * cell,
          mesh,
        );
      }
  connect(values, corner, [nx, ny, nz], strides, mesh.faces);
}

/** Where, inside the cell at `at`, the surface passes: the mean of its crossings with the cell's edges. */
function crossing(values: Float32Array, at: number, strides: readonly [number, number, number]): Vec | null {
  const sum: [number, number, number] = [0, 0, 0];
  let count = 0;
  for (let axis = 0; axis < 3; axis++) {
    const u = (axis + 1) % 3;
    const v = (axis + 2) % 3;
    for (let side = 0; side < 4; side++) {
      const start = at + (side & 1) * strides[u]! + (side >> 1) * strides[v]!;
      const a = values[start]!;
      const b = values[start + strides[axis]!]!;
      if (a < 0 === b < 0) continue;
      sum[axis]! += a / (a - b);
      sum[u]! += side & 1;
      sum[v]! += side >> 1;
      count++;
    }
  }
  return count ? [sum[0] / count, sum[1] / count, sum[2] / count] : null;
}

const grad = new Float64Array(3);

function addCorner(blobs: readonly Blob[], x: number, y: number, z: number, mesh: Mesh): void {
  for (let pass = 0; pass < 3; pass++) {
    slope(blobs, x, y, z, grad);
    const square = grad[0]! ** 2 + grad[1]! ** 2 + grad[2]! ** 2 + 1e-9;
    const move = field(blobs, x, y, z) / square;
    x -= move * grad[0]!;
    y -= move * grad[1]!;
    z -= move * grad[2]!;
  }
  const length = Math.hypot(grad[0]!, grad[1]!, grad[2]!) + 1e-9;
  mesh.positions.push(x, y, z);
  const nx = grad[0]! / length;
  const ny = grad[1]! / length;
  const nz = grad[2]! / length;
  mesh.normals.push(nx, ny, nz);
  const shade = Math.round(255 * openness(blobs, x, y, z, nx, ny, nz));
  mesh.shades.push(shade, shade, shade);
}

const PROBES = [0.015, 0.04, 0.09] as const;
const DARKEST = 0.42;

function openness(blobs: readonly Blob[], x: number, y: number, z: number, nx: number, ny: number, nz: number): number {
  let open = 0;
  for (const far of PROBES)
    open += Math.min(1, Math.max(0, field(blobs, x + far * nx, y + far * ny, z + far * nz) / far));
  return DARKEST + (1 - DARKEST) * (open / PROBES.length);
}

/** Every grid edge that crosses the surface is shared by four cells: their corners make one quad. */
function connect(
  values: Float32Array,
  corner: Int32Array,
  size: readonly [number, number, number],
  strides: readonly [number, number, number],
  faces: number[],
): void {
  for (let k = 0, at = 0; k < size[2]; k++)
    for (let j = 0; j < size[1]; j++)
      for (let i = 0; i < size[0]; i++, at++) {
        const place = [i, j, k];
        for (let axis = 0; axis < 3; axis++) {
          const u = (axis + 1) % 3;
          const v = (axis + 2) % 3;
          if (!place[u] || !place[v] || place[axis]! + 1 >= size[axis]!) continue;
          const inside = values[at]! < 0;
          if (inside === values[at + strides[axis]!]! < 0) continue;
          const a = corner[at - strides[u]! - strides[v]!]!;
          const b = corner[at - strides[v]!]!;
          const c = corner[at]!;
          const d = corner[at - strides[u]!]!;
          if (a < 0 || b < 0 || c < 0 || d < 0) continue;
          if (inside) faces.push(a, b, c, a, c, d);
          else faces.push(a, c, b, a, d, c);
        }
      }
}
