// The translucent skin of the simulated arm: a tube along shoulder, elbow and wrist. From each of its centres rays go
// out to the surface of the arm's soft clay, so it flows into the chest and never tears at a joint. Seen face on it is
// glass, at its edges it is clay: the outline stays readable and the muscles stay visible.
import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  type Vector3,
} from 'three';
import { type Blob, field, gather } from './field';
import { MIDDLE } from './figure';
import type { Limb } from './limb';
import type { Palette } from './palette';

const SIDES = 16;
/** cross-sections in the shoulder, the upper arm, the forearm and the palm */
const STRETCHES = [6, 15, 13, 3] as const;
const WRIST = STRETCHES[0] + STRETCHES[1] + STRETCHES[2];
const RINGS = WRIST + STRETCHES[3] + 1;
const ROOT = [-0.02, MIDDLE - 0.09, -0.03] as const;
/** how often neighbouring centres are averaged: rounds the corners at shoulder and elbow */
const ROUNDING = 6;
const STEPS = 6;
const GLASS = 0.23;

const COS = Float64Array.from({ length: SIDES }, (_, i) => Math.cos((2 * Math.PI * i) / SIDES));
const SIN = Float64Array.from({ length: SIDES }, (_, i) => Math.sin((2 * Math.PI * i) / SIDES));

const smooth = (from: number, to: number, x: number): number => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};

export class Skin {
  readonly group = new Group();
  private readonly geometry = new BufferGeometry();
  private readonly position = new BufferAttribute(new Float32Array(RINGS * SIDES * 3), 3).setUsage(DynamicDrawUsage);
  private readonly normal = new BufferAttribute(new Float32Array(RINGS * SIDES * 3), 3).setUsage(DynamicDrawUsage);
  private readonly fine = faces(1);
  private readonly rough = faces(2);
  private readonly centres = new Float64Array(RINGS * 3);
  private readonly out = new Float64Array(3);
  /** the blobs that matter for the ring in work */
  private readonly near: (Blob | undefined)[];
  private count = 0;
  private readonly depth = new MeshBasicMaterial({
    colorWrite: false,
    transparent: true,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  private readonly material = new MeshLambertMaterial({ transparent: true, depthWrite: false });

  /** `blobs`: the soft clay the skin lies on; moved by others */
  constructor(private readonly blobs: readonly Blob[]) {
    this.near = Array<undefined>(blobs.length).fill(undefined);
    this.geometry.setAttribute('position', this.position);
    this.geometry.setAttribute('normal', this.normal);
    this.geometry.setAttribute('veil', new BufferAttribute(veil(), 2));
    this.geometry.setIndex(this.fine);
    glassy(this.material);
    // First the depth alone, then the colour: only the nearest layer of skin is drawn, in whatever order it comes.
    [this.depth, this.material].forEach((material, order) => {
      const mesh = new Mesh(this.geometry, material);
      mesh.renderOrder = 1 + order;
      mesh.frustumCulled = false;
      this.group.add(mesh);
    });
  }

  setPalette(colors: Palette): void {
    this.material.color.copy(colors.skin);
  }

  /** Draws every other side alone. */
  setRough(on: boolean): void {
    this.geometry.setIndex(on ? this.rough : this.fine);
  }

  update(limb: Limb): void {
    this.layCentres(limb);
    this.out.set([0, 0, 1]);
    for (let ring = 0; ring < RINGS; ring++) this.layRing(ring);
    this.position.needsUpdate = true;
    this.normal.needsUpdate = true;
  }

  dispose(): void {
    this.geometry.dispose();
    this.depth.dispose();
    this.material.dispose();
  }

  private layCentres({ shoulder, elbow, wrist, palm }: Limb): void {
    const c = this.centres;
    let ring = this.layStretch(0, STRETCHES[0], ROOT[0], ROOT[1], ROOT[2], shoulder);
    ring = this.layStretch(ring, STRETCHES[1], shoulder.x, shoulder.y, shoulder.z, elbow);
    ring = this.layStretch(ring, STRETCHES[2], elbow.x, elbow.y, elbow.z, wrist);
    ring = this.layStretch(ring, STRETCHES[3], wrist.x, wrist.y, wrist.z, palm);
    c[ring * 3] = palm.x;
    c[ring * 3 + 1] = palm.y;
    c[ring * 3 + 2] = palm.z;
    for (let pass = 0; pass < ROUNDING; pass++)
      for (let p = 3; p < (RINGS - 1) * 3; p++) c[p] = 0.25 * c[p - 3]! + 0.5 * c[p]! + 0.25 * c[p + 3]!;
  }

  private layStretch(ring: number, count: number, x: number, y: number, z: number, to: Vector3): number {
    for (let i = 0; i < count; i++, ring++) {
      const t = i / count;
      this.centres[ring * 3] = x + t * (to.x - x);
      this.centres[ring * 3 + 1] = y + t * (to.y - y);
      this.centres[ring * 3 + 2] = z + t * (to.z - z);
    }
    return ring;
  }

  private layRing(ring: number): void {
    const c = this.centres;
    const here = ring * 3;
    const before = Math.max(0, ring - 1) * 3;
    const after = Math.min(RINGS - 1, ring + 1) * 3;
    let tx = c[after]! - c[before]!;
    let ty = c[after + 1]! - c[before + 1]!;
    let tz = c[after + 2]! - c[before + 2]!;
    const length = Math.sqrt(tx * tx + ty * ty + tz * tz) + 1e-9;
    tx /= length;
    ty /= length;
    tz /= length;
    // The direction "out" is carried along from ring to ring, so the tube is never twisted.
    const out = this.out;
    const along = out[0]! * tx + out[1]! * ty + out[2]! * tz;
    const ox = out[0]! - along * tx;
    const oy = out[1]! - along * ty;
    const oz = out[2]! - along * tz;
    const scale = 1 / (Math.sqrt(ox * ox + oy * oy + oz * oz) + 1e-9);
    out[0] = ox * scale;
    out[1] = oy * scale;
    out[2] = oz * scale;
    const sx = ty * out[2] - tz * out[1];
    const sy = tz * out[0] - tx * out[2];
    const sz = tx * out[1] - ty * out[0];
    const limit = FARTHEST[ring]!;
    this.count = gather(this.blobs, c[here]!, c[here + 1]!, c[here + 2]!, limit, this.near);
    for (let i = 0; i < SIDES; i++) {
      const dx = COS[i]! * sx + SIN[i]! * out[0];
      const dy = COS[i]! * sy + SIN[i]! * out[1];
      const dz = COS[i]! * sz + SIN[i]! * out[2];
      this.layCorner(ring * SIDES + i, c[here]!, c[here + 1]!, c[here + 2]!, dx, dy, dz, limit);
    }
  }

  private layCorner(
    corner: number,
    cx: number,
    cy: number,
    cz: number,
    dx: number,
    dy: number,
    dz: number,
    limit: number,
  ): void {
    const { near, count } = this;
    let far = 0.012;
    for (let step = 0; step < STEPS && far < limit; step++)
      far -= field(near, cx + far * dx, cy + far * dy, cz + far * dz, count);
    far = Math.min(limit, Math.max(0.008, far));
    const x = cx + far * dx;
    const y = cy + far * dy;
    const z = cz + far * dz;
    const p = corner * 3;
    const position = this.position.array;
    position[p] = x;
    position[p + 1] = y;
    position[p + 2] = z;
    const here = field(near, x, y, z, count);
    const normal = this.normal.array;
    normal[p] = (field(near, x + 0.001, y, z, count) - here) * 1000;
    normal[p + 1] = (field(near, x, y + 0.001, z, count) - here) * 1000;
    normal[p + 2] = (field(near, x, y, z + 0.001, count) - here) * 1000;
  }
}

/** How far from the centres the skin may be, ring by ring: keeps it from running away through the chest. */
const FARTHEST = Float64Array.from({ length: RINGS }, (_, ring) => {
  const elbow = STRETCHES[0] + STRETCHES[1];
  if (ring < STRETCHES[0]) return 0.13 - 0.04 * (ring / STRETCHES[0]);
  return ring < elbow ? 0.09 - 0.025 * smooth(STRETCHES[0], elbow, ring) : 0.065 - 0.02 * smooth(elbow, RINGS, ring);
});

/** Two numbers per corner: how present the skin is (it dissolves on chest and hand) and how solid (the hand is clay). */
function veil(): Float32Array {
  const values = new Float32Array(RINGS * SIDES * 2);
  for (let corner = 0; corner < RINGS * SIDES; corner++) {
    const ring = Math.floor(corner / SIDES);
    values[corner * 2] = smooth(0.5, STRETCHES[0] + 1.5, ring) * (1 - smooth(WRIST, RINGS - 1.2, ring));
    values[corner * 2 + 1] = smooth(WRIST - 6, WRIST - 1.5, ring);
  }
  return values;
}

function faces(step: number): BufferAttribute {
  const list: number[] = [];
  for (let ring = 0; ring < RINGS - 1; ring++)
    for (let i = 0; i < SIDES; i += step) {
      const a = ring * SIDES + i;
      const b = ring * SIDES + ((i + step) % SIDES);
      list.push(a, b + SIDES, b, a, a + SIDES, b + SIDES);
    }
  return new BufferAttribute(new Uint32Array(list), 1);
}

function glassy(material: MeshLambertMaterial): void {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', 'attribute vec2 veil;\nvarying vec2 vVeil;\n#include <common>')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvVeil = veil;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', 'varying vec2 vVeil;\n#include <common>')
      .replace(
        '#include <opaque_fragment>',
        `float edge = 1.0 - abs(dot(normalize(normal), normalize(vViewPosition)));
         diffuseColor.a = vVeil.x * mix(${GLASS.toFixed(2)} + ${(0.95 - GLASS).toFixed(2)} * edge * edge, 1.0, vVeil.y);
         outgoingLight *= 1.0 - 0.3 * edge * (1.0 - vVeil.y);
         #include <opaque_fragment>`,
      );
  };
}
