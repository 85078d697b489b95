// The borders of the cylinders and the singular points where they meet, drawn over the weave.

import { Group, InstancedMesh, Matrix4, MeshBasicMaterial, SphereGeometry } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

import type { CriticalGraph } from '../../api/package_files.ts';
import { segmentsOf } from '../../state/critical.ts';

const kWidthPx = 2.5;
const kPointRadius = 0.012; // Of the model's radius.

export class CriticalLines {
  readonly root = new Group();
  // Drawn a little nearer than they lie, so that the ribbons beside them don't hide them.
  private readonly material = new LineMaterial({
    linewidth: kWidthPx,
    polygonOffset: true,
    polygonOffsetFactor: -4,
    polygonOffsetUnits: -8,
  });
  private readonly lines: LineSegmentsGeometry | null;
  private readonly ball: SphereGeometry;
  private readonly points: InstancedMesh<SphereGeometry, MeshBasicMaterial>;

  constructor(graph: CriticalGraph, modelRadius: number) {
    this.ball = new SphereGeometry(kPointRadius * modelRadius, 16, 12);
    this.points = new InstancedMesh(this.ball, new MeshBasicMaterial(), graph.points.length);
    graph.points.forEach(([x, y, z], index) => this.points.setMatrixAt(index, new Matrix4().makeTranslation(x, y, z)));
    this.points.frustumCulled = false;
    this.root.add(this.points);
    const segments = segmentsOf(graph.lines);
    this.lines = segments.length === 0 ? null : new LineSegmentsGeometry().setPositions(segments);
    if (this.lines !== null) this.root.add(new LineSegments2(this.lines, this.material));
  }

  paint(colour: string): void {
    this.material.color.set(colour);
    this.points.material.color.set(colour);
  }

  dispose(): void {
    this.lines?.dispose();
    this.ball.dispose();
    this.points.material.dispose();
    this.points.dispose();
    this.material.dispose();
  }
}
