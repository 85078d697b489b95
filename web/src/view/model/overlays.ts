// What is drawn instead of ribbons: the input surface, leaves on it, and quads in colours.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

import type { CriticalGraph, Family, QuadMesh, TriangleMesh } from '../../api/package_files.ts';
import { segmentsOf } from '../../state/critical.ts';
import { vertexNormals } from '../../state/ribbons.ts';
import type { Palette } from './palette.ts';

const kPushedBack = { side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 } as const;

// Every quad has corners of its own, so that each may have its own colour.
export class ColouredQuads {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;

  constructor(quads: QuadMesh) {
    const geometry = new BufferGeometry();
    const shared = vertexNormals(quads);
    const positions = new Float32Array(3 * quads.corners.length);
    const normals = new Float32Array(3 * quads.corners.length);
    quads.corners.forEach((vertex, slot) => {
      positions.set(quads.positions.subarray(3 * vertex, 3 * vertex + 3), 3 * slot);
      normals.set(shared.subarray(3 * vertex, 3 * vertex + 3), 3 * slot);
    });
    const indices = new Uint32Array(6 * quads.quadCount);
    for (let q = 0; q < quads.quadCount; q += 1) indices.set([0, 1, 2, 0, 2, 3].map((k) => 4 * q + k), 6 * q);
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute('normal', new BufferAttribute(normals, 3));
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(positions.length), 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    this.mesh = new Mesh(geometry, new MeshLambertMaterial({ ...kPushedBack, vertexColors: true }));
  }

  // red, green, blue from 0 to 1 per corner, as screens show them.
  colour(colours: Float32Array): void {
    const attribute = this.mesh.geometry.getAttribute('color') as BufferAttribute;
    const linear = new Color();
    for (let at = 0; at < colours.length; at += 3) {
      linear.setRGB(colours[at] ?? 0, colours[at + 1] ?? 0, colours[at + 2] ?? 0, 'srgb');
      attribute.array.set([linear.r, linear.g, linear.b], at);
    }
    attribute.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

export class InputSurface {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;

  constructor({ positions, indices }: TriangleMesh) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    geometry.computeVertexNormals();
    this.mesh = new Mesh(geometry, new MeshLambertMaterial(kPushedBack));
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

const kLeafPx = 1.6;

export class Leaves {
  readonly root = new Group();
  private readonly materials: Readonly<Record<Family, LineMaterial>>;
  private readonly geometries: LineSegmentsGeometry[] = [];

  constructor(graph: CriticalGraph) {
    const material = (): LineMaterial =>
      new LineMaterial({ linewidth: kLeafPx, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
    this.materials = { weft: material(), warp: material() };
    for (const family of ['weft', 'warp'] as const) {
      const segments = segmentsOf(graph.leaves[family]);
      if (segments.length === 0) continue;
      const geometry = new LineSegmentsGeometry().setPositions(segments);
      this.geometries.push(geometry);
      this.root.add(new LineSegments2(geometry, this.materials[family]));
    }
  }

  paint(palette: Palette): void {
    this.materials.weft.color.set(palette.weft);
    this.materials.warp.color.set(palette.warp);
  }

  dispose(): void {
    for (const geometry of this.geometries) geometry.dispose();
    this.materials.weft.dispose();
    this.materials.warp.dispose();
  }
}
