import {
  BufferGeometry,
  DataTexture,
  DoubleSide,
  Float32BufferAttribute,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
} from 'three';
import type { RewardMap } from '../engine/protocol';

/** From the least to the greatest reward; the legend has the same. */
const TONES = ['#35508f', '#5f7fc0', '#a9bfdf', '#f4e6b8', '#f2b84b'].map((tone) =>
  [1, 3, 5].map((at) => parseInt(tone.slice(at, at + 2), 16)),
);
/** Lines of equal reward between the least and the greatest. */
const LINES = 12;

/** Pixels between two places that the map tells. */
const FINER = 4;

/** A reward over a rectangle as a coloured sheet with lines of equal reward. */
export function rewardSheet(map: RewardMap): Mesh {
  const { corner, along, across } = map;
  const [columns, rows] = [FINER * (map.columns - 1) + 1, FINER * (map.rows - 1) + 1];
  const shares = finer(map, columns, rows);
  const pixels = new Uint8Array(4 * columns * rows);
  shares.forEach((share, index) => pixels.set([...tone(share), isLine(shares, index, columns) ? 215 : 140], 4 * index));
  const texture = new DataTexture(pixels, columns, rows);
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = LinearFilter;
  texture.needsUpdate = true;

  const place = (x: number, y: number) => corner.map((at, axis) => at + x * along[axis] + y * across[axis]);
  const geometry = new BufferGeometry();
  const corners = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)];
  geometry.setAttribute('position', new Float32BufferAttribute(corners.flat(), 3));
  geometry.setAttribute('uv', new Float32BufferAttribute([0, 0, 1, 0, 1, 1, 0, 1], 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const sheet = new MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false, side: DoubleSide });
  return new Mesh(geometry, sheet);
}

/** The map at more places, in proportion between those that it tells: from 0 for the least to 1 for the greatest reward. */
function finer(map: RewardMap, columns: number, rows: number): Float32Array {
  const { values } = map;
  const [least, most] = [Math.min(...values), Math.max(...values)];
  const span = Math.max(1e-9, most - least);
  const at = (row: number, column: number) =>
    (values[Math.min(row, map.rows - 1) * map.columns + Math.min(column, map.columns - 1)] - least) / span;
  return Float32Array.from({ length: columns * rows }, (_, index) => {
    const [row, column] = [Math.floor(index / columns) / FINER, (index % columns) / FINER];
    const [r, c] = [Math.floor(row), Math.floor(column)];
    const mix = (a: number, b: number, share: number) => a + (b - a) * share;
    return mix(mix(at(r, c), at(r, c + 1), column - c), mix(at(r + 1, c), at(r + 1, c + 1), column - c), row - r);
  });
}

/** Whether a line of equal reward runs between a place and the next. */
function isLine(shares: Float32Array, index: number, columns: number): boolean {
  const level = (at: number) => Math.floor(shares[at] * LINES);
  const hasRight = (index + 1) % columns !== 0;
  const [right, above] = [index + 1, index + columns];
  return (hasRight && level(right) !== level(index)) || (above < shares.length && level(above) !== level(index));
}

export function dropSheet(sheet: Mesh) {
  const material = sheet.material as MeshBasicMaterial;
  material.map?.dispose();
  material.dispose();
  sheet.geometry.dispose();
}

function tone(share: number): number[] {
  const at = Math.min(TONES.length - 1.0001, Math.max(0, share * (TONES.length - 1)));
  const [a, b] = [TONES[Math.floor(at)], TONES[Math.floor(at) + 1]];
  return a.map((value, channel) => Math.round(value + (b[channel] - value) * (at - Math.floor(at))));
}
