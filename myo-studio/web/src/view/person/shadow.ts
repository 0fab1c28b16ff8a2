// A soft shade under the feet, so the person stands on the floor and does not float.
import { DataTexture, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, RGBAFormat } from 'three';
import { MIDDLE, floorHeight } from './figure';
import type { Palette } from './palette';

const SIZE = 64;

function blot(): DataTexture {
  const data = new Uint8Array(SIZE * SIZE * 4).fill(255);
  for (let j = 0; j < SIZE; j++)
    for (let i = 0; i < SIZE; i++) {
      const r = Math.hypot((2 * i + 1) / SIZE - 1, (2 * j + 1) / SIZE - 1);
      const t = Math.max(0, 1 - r);
      data[(j * SIZE + i) * 4 + 3] = 255 * t * t * (3 - 2 * t);
    }
  const texture = new DataTexture(data, SIZE, SIZE, RGBAFormat);
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export class Shadow {
  private readonly texture = blot();
  private readonly material = new MeshBasicMaterial({ map: this.texture, transparent: true, depthWrite: false });
  readonly mesh = new Mesh(new PlaneGeometry(1, 1), this.material);

  setPalette(colors: Palette): void {
    this.material.color.copy(colors.shadow);
    this.material.opacity = colors.shadowStrength;
  }

  setSitting(sitting: boolean): void {
    this.mesh.scale.set(sitting ? 1.15 : 0.85, sitting ? 0.9 : 0.95, 1);
    this.mesh.position.set(sitting ? 0.2 : 0.03, MIDDLE, floorHeight(sitting) + 0.002);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.material.dispose();
    this.texture.dispose();
  }
}
