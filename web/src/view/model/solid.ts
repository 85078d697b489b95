// The woven model with its real thickness, one mesh per strip in the colour of its material.

import { BufferAttribute, BufferGeometry, Color, Group, Mesh, MeshLambertMaterial } from 'three';

import type { SolidModel } from '../../api/glb.ts';

const kDimmed = new Color('#b9b6ae'); // What other strips fade to while one is chosen.
const kDimmedPart = 0.65;

// Materials have any colour, that of marks too: a chosen strip is told from the others by theirs.
export class Solid {
  readonly root = new Group();
  private readonly paper: Readonly<Record<'weft' | 'warp', MeshLambertMaterial>>;
  private readonly chosen = new MeshLambertMaterial({ flatShading: true });
  private readonly pointed = new MeshLambertMaterial({ flatShading: true });
  private readonly meshes = new Map<string, Mesh<BufferGeometry, MeshLambertMaterial>>();
  private marked: readonly (string | null)[] = [];

  constructor(private readonly model: SolidModel) {
    const paper = (family: 'weft' | 'warp'): MeshLambertMaterial =>
      new MeshLambertMaterial({ color: new Color().setRGB(...model.colours[family]), flatShading: true });
    this.paper = { weft: paper('weft'), warp: paper('warp') };
    for (const strip of model.strips) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(strip.positions, 3));
      geometry.setIndex(new BufferAttribute(strip.indices, 1));
      const mesh = new Mesh(geometry, this.paper[strip.family]);
      mesh.userData['family'] = strip.family;
      mesh.userData['strip'] = strip.id;
      this.meshes.set(strip.id, mesh);
      this.root.add(mesh);
    }
  }

  mark(pointed: string | null, chosen: string | null): void {
    for (const id of this.marked) {
      const mesh = id === null ? undefined : this.meshes.get(id);
      if (mesh !== undefined) mesh.material = this.paper[mesh.userData['family'] as 'weft' | 'warp'];
    }
    this.marked = [pointed, chosen];
    for (const family of ['weft', 'warp'] as const) {
      const colour = this.paper[family].color.setRGB(...this.model.colours[family]);
      if (chosen !== null) colour.lerp(kDimmed, kDimmedPart);
    }
    this.marked.forEach((id, k) => {
      const mesh = id === null ? undefined : this.meshes.get(id);
      if (mesh !== undefined) mesh.material = k === 1 ? this.chosen : this.pointed;
    });
  }

  paint(mark: string): void {
    this.chosen.color.set(mark);
    this.chosen.emissive.set(mark).multiplyScalar(0.35);
    this.pointed.color.set(mark).lerp(new Color('#ffffff'), 0.35);
  }

  dispose(): void {
    for (const mesh of this.meshes.values()) mesh.geometry.dispose();
    for (const material of [this.paper.weft, this.paper.warp, this.chosen, this.pointed]) material.dispose();
  }
}
