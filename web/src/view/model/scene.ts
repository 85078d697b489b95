// The 3D view: ribbons of both families over the quad mesh, turned with the mouse or the keyboard.
// Draws only when something changed. Loaded on demand, because three.js is most of the page's weight.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Sphere,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

import type { Family, QuadMesh } from '../../api/package_files.ts';
import { buildRibbons, type Ribbons, vertexNormals } from '../../state/ribbons.ts';
import type { StripIndex } from '../../state/strip_index.ts';

export type ViewMode = 'woven' | 'weft' | 'warp' | 'surface';

export interface ModelContent {
  readonly mesh: QuadMesh;
  readonly warpOnTop: Uint8Array;
  readonly index: StripIndex;
}

export interface Palette {
  readonly weft: string;
  readonly warp: string;
  readonly surface: string;
  readonly line: string;
  readonly mark: string;
}

export interface ModelScene {
  show(mode: ViewMode): void;
  mark(pointed: string | null, chosen: string | null): void;
  stripAt(clientX: number, clientY: number): string | null;
  turn(dx: number, dy: number): void; // Radians.
  zoom(factor: number): void;
  reset(): void;
  paint(palette: Palette): void;
  dispose(): void;
}

// More segments than this per cell cost more than they show.
function stepsFor(quads: number): number {
  if (quads > 12_000) return 2;
  return quads > 4_000 ? 4 : 6;
}

function geometryOf(ribbons: Ribbons): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(ribbons.positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(ribbons.normals, 3));
  geometry.setAttribute('color', new BufferAttribute(ribbons.shades, 3));
  geometry.setIndex(new BufferAttribute(ribbons.indices, 1));
  return geometry;
}

function surfaceGeometry(mesh: QuadMesh): BufferGeometry {
  const indices = new Uint32Array(6 * mesh.quadCount);
  for (let q = 0; q < mesh.quadCount; q += 1) {
    const [a, b, c, d] = mesh.corners.subarray(4 * q, 4 * q + 4) as unknown as [number, number, number, number];
    indices.set([a, b, c, a, c, d], 6 * q);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(mesh.positions), 3));
  geometry.setAttribute('normal', new BufferAttribute(Float32Array.from(vertexNormals(mesh)), 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.computeBoundingSphere();
  return geometry;
}

function edgeGeometry(mesh: QuadMesh, surface: BufferGeometry): BufferGeometry {
  const indices = new Uint32Array(2 * mesh.corners.length);
  mesh.corners.forEach((vertex, slot) => {
    indices.set([vertex, mesh.corners[slot % 4 === 3 ? slot - 3 : slot + 1] ?? 0], 2 * slot);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', surface.getAttribute('position'));
  geometry.setIndex(new BufferAttribute(indices, 1));
  return geometry;
}

// The triangles of some quads of `from`, sharing its vertices.
function quadsOf(from: BufferGeometry, quads: readonly number[]): BufferGeometry {
  const all = from.getIndex()?.array ?? new Uint32Array();
  const each = quads.length === 0 ? 0 : (from.userData['perQuad'] as number);
  const indices = new Uint32Array(quads.length * each);
  quads.forEach((quad, k) => indices.set(all.slice(quad * each, (quad + 1) * each), k * each));
  const geometry = new BufferGeometry();
  for (const name of ['position', 'normal'] as const) geometry.setAttribute(name, from.getAttribute(name));
  geometry.setIndex(new BufferAttribute(indices, 1));
  return geometry;
}

function marker(): Mesh<BufferGeometry, MeshLambertMaterial> {
  const material = new MeshLambertMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.visible = false;
  mesh.renderOrder = 1;
  return mesh;
}

class Model {
  readonly root = new Group();
  readonly surface: BufferGeometry;
  readonly bounds: Sphere;
  private readonly ribbons: Readonly<Record<Family, BufferGeometry>>;
  private readonly parts: Readonly<Record<Family, Mesh<BufferGeometry, MeshLambertMaterial>>>;
  private readonly skin: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly edges: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly pointed = marker();
  private readonly chosen = marker();
  // A geometry shares its vertices with what it marks, and freeing it would free those too: kept for each
  // strip that was ever marked, which adds up to one more index of the ribbons at most.
  private readonly marked = new Map<string, BufferGeometry>();
  mode: ViewMode = 'woven';

  constructor(private readonly content: ModelContent) {
    const { mesh, warpOnTop } = content;
    const steps = stepsFor(mesh.quadCount);
    const ribbon = (family: Family): BufferGeometry => {
      const built = buildRibbons(mesh, warpOnTop, family, { steps });
      const geometry = geometryOf(built);
      geometry.userData['perQuad'] = built.indicesPerQuad;
      return geometry;
    };
    this.surface = surfaceGeometry(mesh);
    this.surface.userData['perQuad'] = 6;
    this.bounds = this.surface.boundingSphere ?? new Sphere();
    this.ribbons = { weft: ribbon('weft'), warp: ribbon('warp') };
    const paper = (): MeshLambertMaterial => new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });
    this.parts = { weft: new Mesh(this.ribbons.weft, paper()), warp: new Mesh(this.ribbons.warp, paper()) };
    const skin = new MeshLambertMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.skin = new Mesh(this.surface, skin);
    this.edges = new LineSegments(edgeGeometry(mesh, this.surface), new LineBasicMaterial());
    this.root.add(this.parts.weft, this.parts.warp, this.skin, this.edges, this.pointed, this.chosen);
    this.show('woven');
  }

  show(mode: ViewMode): void {
    this.mode = mode;
    this.parts.weft.visible = mode === 'woven' || mode === 'weft';
    this.parts.warp.visible = mode === 'woven' || mode === 'warp';
    this.skin.visible = mode === 'surface';
    this.edges.visible = mode === 'surface';
  }

  mark(pointed: string | null, chosen: string | null): void {
    this.put(this.pointed, pointed === chosen ? null : pointed);
    this.put(this.chosen, chosen);
  }

  private put(mesh: Mesh, id: string | null): void {
    const strip = id === null ? undefined : this.content.index.strips.get(id);
    mesh.visible = strip !== undefined;
    if (strip === undefined) return;
    const onSurface = this.mode === 'surface';
    const key = `${onSurface ? 'surface' : 'ribbon'}/${strip.id}`;
    const geometry = this.marked.get(key) ?? quadsOf(onSurface ? this.surface : this.ribbons[strip.family], strip.quads);
    this.marked.set(key, geometry);
    mesh.geometry = geometry;
  }

  paint(palette: Palette): void {
    this.parts.weft.material.color.set(palette.weft);
    this.parts.warp.material.color.set(palette.warp);
    this.skin.material.color.set(palette.surface);
    this.edges.material.color.set(palette.line);
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
  }
}

const kFieldDeg = 32;
const kFromDirection = new Vector3(0.55, -0.95, 0.75).normalize();

class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(kFieldDeg, 1, 0.1, 1000);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  private readonly resizing: ResizeObserver;
  private frame = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly bounds: Sphere) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight('#ffffff', 2.2);
    sun.position.set(-0.5, 0.8, 0.9);
    this.camera.add(sun);
    this.scene.add(new AmbientLight('#ffffff', 1.45), this.camera);
    this.controls = new OrbitControls(this.camera, canvas);
    // The wheel belongs to the page until the view was clicked or reached by keyboard.
    this.controls.enableZoom = false;
    canvas.addEventListener('focus', () => (this.controls.enableZoom = true));
    canvas.addEventListener('blur', () => (this.controls.enableZoom = false));
    this.controls.addEventListener('change', () => this.draw());
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(canvas);
    this.resize();
    this.reset();
  }

  draw(): void {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.scene, this.camera);
    });
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  reset(): void {
    const { center, radius } = this.bounds;
    const half = Math.atan(Math.tan((kFieldDeg * Math.PI) / 360) * Math.min(1, this.camera.aspect));
    const distance = (radius / Math.sin(half)) * 1.02;
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.position.copy(center).addScaledVector(kFromDirection, distance);
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(center);
    this.controls.minDistance = radius * 0.2;
    this.controls.maxDistance = distance * 4;
    this.controls.update();
    this.draw();
  }

  // Moves the camera about the target; the pole points along the camera's up.
  move(change: (around: Spherical) => void): void {
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    // Spherical's pole is y: swap the axes there and back.
    const around = new Spherical().setFromCartesianCoords(offset.y, offset.z, offset.x);
    change(around);
    around.makeSafe();
    around.radius = Math.min(this.controls.maxDistance, Math.max(this.controls.minDistance, around.radius));
    const moved = new Vector3().setFromSpherical(around);
    this.camera.position.set(target.x + moved.z, target.y + moved.x, target.z + moved.y);
    this.controls.update();
    this.draw();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.resizing.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
  }
}

// Throws if the browser has no WebGL.
export function createModelScene(canvas: HTMLCanvasElement, content: ModelContent): ModelScene {
  const model = new Model(content);
  const stage = new Stage(canvas, model.bounds);
  stage.scene.add(model.root);
  const target = new Mesh(model.surface, new MeshBasicMaterial({ side: DoubleSide }));
  const raycaster = new Raycaster();

  function stripAt(clientX: number, clientY: number): string | null {
    const box = canvas.getBoundingClientRect();
    const x = ((clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((clientY - box.top) / box.height) * 2;
    raycaster.setFromCamera(new Vector2(x, y), stage.camera);
    const hit = raycaster.intersectObject(target)[0];
    if (hit === undefined || hit.faceIndex === null || hit.faceIndex === undefined || !hit.face) return null;
    return model.stripOf(hit.faceIndex >> 1, hit.face.normal.dot(raycaster.ray.direction) < 0);
  }

  const drawn = <T extends readonly unknown[]>(act: (...values: T) => void) => (...values: T): void => {
    act(...values);
    stage.draw();
  };

  return {
    show: drawn((mode: ViewMode) => model.show(mode)),
    mark: drawn((pointed: string | null, chosen: string | null) => model.mark(pointed, chosen)),
    paint: drawn((palette: Palette) => model.paint(palette)),
    stripAt,
    turn: (dx, dy) =>
      stage.move((around) => {
        around.theta -= dx;
        around.phi -= dy;
      }),
    zoom: (factor) => stage.move((around) => (around.radius /= factor)),
    reset: () => stage.reset(),
    dispose() {
      model.dispose();
      stage.dispose();
    },
  };
}
