// Quad meshes and ribbons as three.js geometries. `userData.perQuad` tells how many indices a quad has.

import { BufferAttribute, BufferGeometry } from 'three';

import type { QuadMesh } from '../../api/package_files.ts';
import { type Ribbons, vertexNormals } from '../../state/ribbons.ts';

// More segments than this per cell cost more than they show.
export function stepsFor(quads: number): number {
  if (quads > 12_000) return 2;
  return quads > 4_000 ? 4 : 6;
}

export function ribbonGeometry(ribbons: Ribbons): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(ribbons.positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(ribbons.normals, 3));
  geometry.setAttribute('color', new BufferAttribute(ribbons.shades, 3));
  geometry.setIndex(new BufferAttribute(ribbons.indices, 1));
  geometry.userData['perQuad'] = ribbons.indicesPerQuad;
  return geometry;
}

export function surfaceGeometry(mesh: QuadMesh): BufferGeometry {
  const indices = new Uint32Array(6 * mesh.quadCount);
  for (let q = 0; q < mesh.quadCount; q += 1) {
    const corner = (k: number): number => mesh.corners[4 * q + k] ?? 0;
    indices.set([0, 1, 2, 0, 2, 3].map(corner), 6 * q);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(mesh.positions), 3));
  geometry.setAttribute('normal', new BufferAttribute(Float32Array.from(vertexNormals(mesh)), 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.userData['perQuad'] = 6;
  geometry.computeBoundingSphere();
  return geometry;
}

export function edgeGeometry(mesh: QuadMesh, surface: BufferGeometry): BufferGeometry {
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
export function quadsOf(from: BufferGeometry, quads: readonly number[]): BufferGeometry {
  const all = from.getIndex()?.array ?? new Uint32Array();
  const each = quads.length === 0 ? 0 : (from.userData['perQuad'] as number);
  const indices = new Uint32Array(quads.length * each);
  quads.forEach((quad, k) => indices.set(all.slice(quad * each, (quad + 1) * each), k * each));
  const geometry = new BufferGeometry();
  for (const name of ['position', 'normal', 'color'] as const) {
    if (from.hasAttribute(name)) geometry.setAttribute(name, from.getAttribute(name));
  }
  geometry.setIndex(new BufferAttribute(indices, 1));
  return geometry;
}
