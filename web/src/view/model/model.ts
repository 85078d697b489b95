// What is drawn: the ribbons of both families, the bare surface, and the strips that are marked.

import {
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Sphere,
} from 'three';

import type { SolidModel } from '../../api/glb.ts';
import type { CriticalGraph, Family, QuadMesh, TriangleMesh } from '../../api/package_files.ts';
import { buildRibbons } from '../../state/ribbons.ts';
import type { StripIndex } from '../../state/strip_index.ts';
import { CriticalLines } from './critical_lines.ts';
import { cylinderColours } from '../../state/heat.ts';
import { edgeGeometry, quadsOf, ribbonGeometry, stepsFor, surfaceGeometry } from './geometry.ts';
import { ColouredQuads, InputSurface, Leaves } from './overlays.ts';
import type { Palette } from './palette.ts';
import { Solid } from './solid.ts';

export const kViewModes = ['woven', 'solid', 'weft', 'warp', 'quads', 'cylinders', 'heat', 'surface', 'leaves'] as const;
export type ViewMode = (typeof kViewModes)[number];

export interface ModelContent {
  readonly mesh: QuadMesh;
  readonly warpOnTop: Uint8Array;
  readonly index: StripIndex;
  readonly critical: CriticalGraph;
}

const kRibbonModes: ReadonlySet<ViewMode> = new Set(['woven', 'weft', 'warp']);

function marker(): Mesh<BufferGeometry, MeshLambertMaterial> {
  const material = new MeshLambertMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.visible = false;
  mesh.renderOrder = 1;
  return mesh;
}

export class Model {
  readonly root = new Group();
  readonly surface: BufferGeometry;
  readonly bounds: Sphere;
  private readonly ribbons: Readonly<Record<Family, BufferGeometry>>;
  private readonly parts: Readonly<Record<Family, Mesh<BufferGeometry, MeshLambertMaterial>>>;
  private readonly skin: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly edges: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly critical: CriticalLines;
  private readonly pointed = marker();
  private readonly chosen = marker();
  // A geometry shares its vertices with what it marks, and freeing it would free those too: kept for each
  // strip that was ever marked, which adds up to one more index of the ribbons at most.
  private readonly marked = new Map<string, BufferGeometry>();
  private solid: Solid | null = null; // This and the next are fetched when they are first looked at.
  private input: InputSurface | null = null;
  private coloured: ColouredQuads | null = null; // Made then.
  private leaves: Leaves | null = null;
  private heat: Float32Array | null = null;
  private marks: readonly [string | null, string | null] = [null, null];
  private palette: Palette | null = null;
  mode: ViewMode = 'woven';

  constructor(private readonly content: ModelContent) {
    const { mesh, warpOnTop } = content;
    const steps = stepsFor(mesh.quadCount);
    const ribbon = (family: Family): BufferGeometry => {
      return ribbonGeometry(buildRibbons(mesh, warpOnTop, family, { steps }));
    };
    this.surface = surfaceGeometry(mesh);
    this.bounds = this.surface.boundingSphere ?? new Sphere();
    this.ribbons = { weft: ribbon('weft'), warp: ribbon('warp') };
    const paper = (): MeshLambertMaterial => new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });
    this.parts = { weft: new Mesh(this.ribbons.weft, paper()), warp: new Mesh(this.ribbons.warp, paper()) };
    const skin = new MeshLambertMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.skin = new Mesh(this.surface, skin);
    this.edges = new LineSegments(edgeGeometry(mesh, this.surface), new LineBasicMaterial());
    this.critical = new CriticalLines(content.critical, this.bounds.radius);
    this.root.add(this.parts.weft, this.parts.warp, this.skin, this.edges, this.pointed, this.chosen, this.critical.root);
    this.show('woven');
  }

  show(mode: ViewMode): void {
    this.mode = mode;
    this.parts.weft.visible = mode === 'woven' || mode === 'weft';
    this.parts.warp.visible = mode === 'woven' || mode === 'warp';
    const onInput = mode === 'surface' || mode === 'leaves';
    this.skin.visible = mode === 'quads' || (onInput && this.input === null);
    this.edges.visible = mode === 'quads' || mode === 'cylinders' || mode === 'heat';
    if (this.input !== null) this.input.mesh.visible = onInput;
    this.showColours(mode);
    this.showLeaves(mode === 'leaves');
    if (this.solid !== null) this.solid.root.visible = mode === 'solid';
    // Its own lines would lie inside the slabs.
    this.critical.root.visible = mode !== 'solid';
  }

  private showColours(mode: ViewMode): void {
    const colours = mode === 'cylinders' ? cylinderColours(this.content.mesh) : mode === 'heat' ? this.heat : null;
    if (colours !== null && this.coloured === null) {
      this.coloured = new ColouredQuads(this.content.mesh);
      this.root.add(this.coloured.mesh);
    }
    if (this.coloured === null) return;
    this.coloured.mesh.visible = colours !== null;
    if (colours !== null) this.coloured.colour(colours);
  }

  private showLeaves(visible: boolean): void {
    if (visible && this.leaves === null) {
      this.leaves = new Leaves(this.content.critical);
      this.root.add(this.leaves.root);
      if (this.palette !== null) this.leaves.paint(this.palette);
    }
    if (this.leaves !== null) this.leaves.root.visible = visible;
  }

  // Colours per corner of every quad, for the mode "heat".
  setHeat(colours: Float32Array): void {
    this.heat = colours;
    this.show(this.mode);
  }

  addInput(surface: TriangleMesh): void {
    if (this.input !== null) return;
    this.input = new InputSurface(surface);
    this.root.add(this.input.mesh);
    if (this.palette !== null) this.input.mesh.material.color.set(this.palette.surface);
    this.show(this.mode);
  }

  addSolid(model: SolidModel): void {
    if (this.solid !== null) return;
    this.solid = new Solid(model);
    this.root.add(this.solid.root);
    if (this.palette !== null) this.solid.paint(this.palette.mark);
    this.show(this.mode);
    this.mark(...this.marks);
  }

  mark(pointed: string | null, chosen: string | null): void {
    this.marks = [pointed, chosen];
    const solid = this.mode === 'solid';
    this.solid?.mark(pointed, chosen);
    this.put(this.pointed, solid || pointed === chosen ? null : pointed);
    this.put(this.chosen, solid ? null : chosen);
  }

  private put(mesh: Mesh, id: string | null): void {
    const strip = id === null ? undefined : this.content.index.strips.get(id);
    mesh.visible = strip !== undefined;
    if (strip === undefined) return;
    const onSurface = !kRibbonModes.has(this.mode);
    const key = `${onSurface ? 'surface' : 'ribbon'}/${strip.id}`;
    const geometry = this.marked.get(key) ?? quadsOf(onSurface ? this.surface : this.ribbons[strip.family], strip.quads);
    this.marked.set(key, geometry);
    mesh.geometry = geometry;
  }

  paint(palette: Palette): void {
    this.palette = palette;
    this.solid?.paint(palette.mark);
    this.leaves?.paint(palette);
    this.input?.mesh.material.color.set(palette.surface);
    this.parts.weft.material.color.set(palette.weft);
    this.parts.warp.material.color.set(palette.warp);
    this.skin.material.color.set(palette.surface);
    this.edges.material.color.set(palette.line);
    this.critical.paint(palette.critical);
    this.chosen.material.color.set(palette.mark);
    this.chosen.material.emissive.set(palette.mark).multiplyScalar(0.35);
    this.pointed.material.color.set(palette.mark).lerp(new Color('#ffffff'), 0.35);
  }

  // Which of a quad's two strips is seen from `towards` (out of the surface or from behind).
  stripOf(quad: number, outside: boolean): string | null {
    const { index, warpOnTop } = this.content;
    const warp = this.mode === 'warp' || (this.mode !== 'weft' && (warpOnTop[quad] === 1) === outside);
    return (warp ? index.warpOfQuad[quad] : index.weftOfQuad[quad]) ?? null;
  }

  dispose(): void {
    const own = [this.surface, this.ribbons.weft, this.ribbons.warp, this.edges.geometry];
    for (const geometry of [...own, ...this.marked.values()]) geometry.dispose();
    for (const mesh of [this.parts.weft, this.parts.warp, this.skin, this.pointed, this.chosen]) mesh.material.dispose();
    this.edges.material.dispose();
    this.critical.dispose();
    for (const part of [this.solid, this.input, this.coloured, this.leaves]) part?.dispose();
  }
}
