// What a model knows of how its parts look: triangles fixed to them, painted as bone.
import { BufferAttribute, BufferGeometry, Group, Matrix4, Mesh, MeshLambertMaterial, Quaternion, Vector3 } from 'three';
import type { LookShape } from '../../engine/protocol';
import type { Palette } from './palette';

const PART = 7;

export class Looks {
  readonly group = new Group();
  private readonly material = new MeshLambertMaterial();
  private readonly meshes: { mesh: Mesh; part: number; own: Matrix4 }[];
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();
  private readonly whole = new Vector3(1, 1, 1);

  constructor(looks: readonly LookShape[]) {
    this.meshes = looks.map((look) => {
      const mesh = new Mesh(geometry(look), this.material);
      mesh.matrixAutoUpdate = false;
      this.group.add(mesh);
      const own = new Matrix4().compose(
        new Vector3().fromArray(look.pos),
        new Quaternion().fromArray(look.quat),
        this.whole,
      );
      return { mesh, part: look.part, own };
    });
  }

  update(parts: Float32Array): void {
    const { place, turn, whole } = this;
    for (const { mesh, part, own } of this.meshes) {
      place.fromArray(parts, part * PART);
      turn.fromArray(parts, part * PART + 3);
      mesh.matrix.compose(place, turn, whole).multiply(own);
      mesh.matrixWorldNeedsUpdate = true;
    }
  }

  paint({ bone }: Palette): void {
    this.material.color.copy(bone);
  }

  dispose(): void {
    for (const { mesh } of this.meshes) mesh.geometry.dispose();
    this.material.dispose();
  }
}

function geometry({ step, points, faces }: LookShape): BufferGeometry {
  const made = new BufferGeometry();
  made.setAttribute(
    'position',
    new BufferAttribute(
      Float32Array.from(new Int16Array(bytes(points)), (x) => step * x),
      3,
    ),
  );
  made.setIndex(new BufferAttribute(new Uint16Array(bytes(faces)), 1));
  made.computeVertexNormals();
  return made;
}

const bytes = (text: string): ArrayBuffer => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
