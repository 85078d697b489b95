// A small package of a woven torus, as `leafcutter weave` would write it: for developing the dashboard
// and for its tests. Exact unfolding and a simple nesting; no fit, kerf or certificate.

import { createHash } from 'node:crypto';

const kSheet = { width: 600, height: 400 };

const round = (value, digits = 3) => Number(value.toFixed(digits));
const minus = (p, q) => p.map((x, k) => x - q[k]);
const distance = (p, q) => Math.hypot(...minus(p, q));

function torusQuads({ major, minor, columns, rows }) {
  const vertex = (i, j) => (i % columns) * rows + (j % rows);
  const vertices = [];
  for (let i = 0; i < columns; i += 1) {
    for (let j = 0; j < rows; j += 1) {
      const [u, v] = [(2 * Math.PI * i) / columns, (2 * Math.PI * j) / rows];
      const reach = major + minor * Math.cos(v);
      vertices.push([reach * Math.cos(u), reach * Math.sin(u), minor * Math.sin(v)]);
    }
  }
  const quads = [];
  for (let i = 0; i < columns; i += 1) {
    for (let j = 0; j < rows; j += 1) quads.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
  }
  return { vertices, quads };
}

function weaveStrips({ columns, rows }) {
  const strips = [];
  for (let j = 0; j < rows; j += 1) {
    const quads = Array.from({ length: columns }, (_, i) => i * rows + j);
    strips.push({ id: `W${j + 1}`, family: 'weft', cylinders: [0], closed: true, quads, pieces: [] });
  }
  for (let i = 0; i < columns; i += 1) {
    const quads = Array.from({ length: rows }, (_, j) => i * rows + j);
    strips.push({ id: `P${i + 1}`, family: 'warp', cylinders: [0], closed: true, quads, pieces: [] });
  }
  return strips;
}

// The point at distances `toP` and `toQ` from the plane points p and q, left of p→q.
function triangulate(p, q, toP, toQ) {
  const [dx, dy] = minus(q, p);
  const base = Math.hypot(dx, dy);
  const along = (toP ** 2 - toQ ** 2 + base ** 2) / (2 * base);
  const up = Math.sqrt(Math.max(0, toP ** 2 - along ** 2));
  return [p[0] + (along * dx - up * dy) / base, p[1] + (along * dy + up * dx) / base];
}

// Rungs of `cells` in the plane: isometric on all edges and on the folded diagonal of each cell.
function unfold(mesh, family, cells) {
  const corners = (quad) => {
    const [a, b, c, d] = mesh.quads[quad].map((v) => mesh.vertices[v]);
    // Right and left end of the first rung, right and left end of the next one.
    return family === 'weft' ? [a, d, b, c] : [b, a, c, d];
  };
  const [firstRight, firstLeft] = corners(cells[0]);
  let right = [0, 0];
  let leftEnd = [0, distance(firstRight, firstLeft)];
  const rungs = { left: [leftEnd], right: [right] };
  for (const cell of cells) {
    const [p, q, r, s] = corners(cell);
    // s lies right of the rung q→p, r right of the fold p–s.
    const s2 = triangulate(leftEnd, right, distance(q, s), distance(p, s));
    const r2 = triangulate(s2, right, distance(s, r), distance(p, r));
    [right, leftEnd] = [r2, s2];
    rungs.left.push(leftEnd);
    rungs.right.push(right);
  }
  return rungs;
}

function rotate([x, y], degrees) {
  const angle = (degrees * Math.PI) / 180;
  return [Math.cos(angle) * x - Math.sin(angle) * y, Math.sin(angle) * x + Math.cos(angle) * y];
}

function tick(from, to) {
  const [dx, dy] = minus(to, from);
  return [from, [from[0] + 0.18 * dx, from[1] + 0.18 * dy]].map((p) => p.map((x) => round(x)));
}

function makePieces(mesh, strips, parts) {
  return strips.flatMap((strip) => {
    const length = Math.ceil(strip.quads.length / parts[strip.family]);
    const pieces = [];
    for (let first = 0; first < strip.quads.length; first += length) {
      const cells = strip.quads.slice(first, first + length);
      const { left, right } = unfold(mesh, strip.family, cells);
      const id = `${strip.id}.${pieces.length + 1}`;
      const outline = [...right, ...left.slice().reverse()].map((p) => p.map((x) => round(x)));
      const marks = [];
      for (let k = 1; k < left.length - 1; k += 1) {
        marks.push({ kind: 'score', path: tick(left[k], right[k]) }, { kind: 'score', path: tick(right[k], left[k]) });
      }
      const [dx, dy] = minus(right[1], right[0]);
      const angle = (Math.atan2(dy, dx) * 180) / Math.PI;
      const at = [0, 1].map((k) => round(right[0][k] + 0.3 * (left[0][k] - right[0][k]) + 0.1 * (right[1][k] - right[0][k])));
      marks.push({ kind: 'engrave', text: id, at, angle_deg: round(angle), height_mm: 3 });
      strip.pieces.push(id);
      pieces.push({ id, strip: strip.id, first_cell: first, cell_count: cells.length, left, right, bend: cells.map(() => 'ac'), outline, marks });
    }
    return pieces;
  });
}

// Points on and inside an outline, close enough to stand for it on a grid of 2 mm.
function samples(piece) {
  const points = [];
  const between = (p, q) => {
    const steps = Math.max(1, Math.ceil(distance(p, q) / 1.5));
    for (let k = 0; k <= steps; k += 1) points.push([0, 1].map((x) => p[x] + ((q[x] - p[x]) * k) / steps));
  };
  const { left, right } = piece;
  for (const t of [-0.1, 0.15, 0.4, 0.6, 0.85, 1.1]) {
    const at = (k) => [0, 1].map((x) => left[k][x] + t * (right[k][x] - left[k][x]));
    for (let k = 1; k < left.length; k += 1) between(at(k - 1), at(k));
  }
  return points;
}

// First fit on a grid, left to right and upwards.
class Grid {
  constructor() {
    this.columns = kSheet.width / 2;
    this.rows = kSheet.height / 2;
    this.taken = new Uint8Array(this.columns * this.rows);
  }

  cell([x, y]) {
    const [column, row] = [Math.floor(x / 2), Math.floor(y / 2)];
    const inside = column >= 2 && row >= 2 && column < this.columns - 2 && row < this.rows - 2;
    return inside ? row * this.columns + column : -1;
  }

  place(points) {
    for (let x = 4; x < kSheet.width; x += 4) {
      for (let y = 4; y < kSheet.height; y += 4) {
        const free = points.every(([px, py]) => {
          const cell = this.cell([px + x, py + y]);
          return cell >= 0 && this.taken[cell] === 0;
        });
        if (!free) continue;
        for (const [px, py] of points) this.taken[this.cell([px + x, py + y])] = 1;
        return [x, y];
      }
    }
    return null;
  }
}

function nestFamily(pieces, family, firstId) {
  const sheets = [];
  let grid = null;
  for (const piece of pieces) {
    const [dx, dy] = minus(piece.right.at(-1), piece.right[0]);
    const rotation = round(90 - (Math.atan2(dy, dx) * 180) / Math.PI, 2);
    const turned = samples(piece).map((p) => rotate(p, rotation));
    const low = [0, 1].map((k) => Math.min(...turned.map((p) => p[k])));
    const points = turned.map((p) => minus(p, low));
    let spot = grid?.place(points);
    if (!spot) {
      grid = new Grid();
      const material = family === 'weft' ? 'paper-160-yellow' : 'paper-160-blue';
      sheets.push({ id: firstId + sheets.length, material, family, width_mm: kSheet.width, height_mm: kSheet.height, placements: [] });
      spot = grid.place(points);
    }
    if (!spot) throw new Error(`${piece.id} does not fit an empty sheet`);
    sheets.at(-1).placements.push({
      piece: piece.id, x_mm: round(spot[0] - low[0]), y_mm: round(spot[1] - low[1]), rotation_deg: rotation, mirrored: false,
    });
  }
  return sheets;
}

function sheetPaths(sheet, pieces) {
  const scored = [];
  const cut = [];
  for (const placement of sheet.placements) {
    const put = (p) => rotate(p, placement.rotation_deg).map((x, k) => round(x + (k === 0 ? placement.x_mm : placement.y_mm)));
    const piece = pieces.get(placement.piece);
    for (const mark of piece.marks) if (mark.path) scored.push(mark.path.map(put));
    cut.push([...piece.outline, piece.outline[0]].map(put));
  }
  return { scored, cut };
}

function writeGcode(sheet, { scored, cut }, job) {
  const lines = [`; Leafcutter: ${job}, sheet ${sheet.id}, ${sheet.material}`, '; estimated time: 240 s', 'G21 G90', 'M4 S0'];
  const burn = (path, power, feed) => {
    lines.push(`G0 X${path[0][0]} Y${path[0][1]}`);
    path.slice(1).forEach(([x, y], k) => lines.push(`G1 X${x} Y${y}${k === 0 ? ` S${power} F${feed}` : ''}`));
  };
  for (const path of scored) burn(path, 180, 3000);
  for (const path of cut) burn(path, 800, 1200);
  lines.push('M5 S0', 'G0 X0 Y0', '');
  return lines.join('\n');
}

function writeSvg(sheet, { scored, cut }) {
  const d = (paths) => paths.map((path) => `M${path.map(([x, y]) => `${x} ${round(sheet.height_mm - y)}`).join('L')}`).join('');
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${sheet.width_mm}mm" height="${sheet.height_mm}mm" viewBox="0 0 ${sheet.width_mm} ${sheet.height_mm}" fill="none"><path stroke="#00f" d="${d(scored)}"/><path stroke="#f00" d="${d(cut)}"/></svg>\n`;
}

function report(mesh, layout, counts) {
  return {
    format: 'leafcutter-report/1',
    input: { file: 'torus.off', vertices: 2048, faces: 4096, scale: 1 },
    topology: { genus: 1, boundary_loops: 0, euler: 0 },
    surface: { removed_area_percent: 0 },
    foliation: {
      mode: 'torus', cylinders: [{ rows: counts.rows, cols: counts.columns }], singularities: [], punctures: [],
      cell_spread: { variation: 0.36, largest_edge: 1.3 },
      alternatives: [
        { name: 'torus', cell_spread: { variation: 0.36, largest_edge: 1.3 }, removed_area_percent: 0, chosen: true },
        { name: 'pants', cell_spread: { variation: 0.9, largest_edge: 3.4 }, removed_area_percent: 0.4, chosen: false },
      ],
    },
    quality: {
      overall: {
        angle_deviation_deg: { max: 3.91, avg: 1.274 },
        crossing_angle_deviation_deg: { max: 0.02, avg: 0.004 },
        surface_distance_percent: { max: 0.412, avg: 0.187 },
        area_distortion_percent: { avg: 0.642 },
        planarity_percent: { max: 2.31, avg: 1.124 },
      },
    },
    nesting: { density_percent: layout.density_percent, sheets: layout.sheets.length },
    timings_s: { read: 0.01, repair: 0.01, foliation: 0.12, quads: 0.08, strips: 0.03, nest: 2.4, toolpath: 0.02, package: 0.04 },
    certificate: { largest_deviation_relative: 3.1e-5 },
    warnings: [],
  };
}

// Rings of warp laid side by side, every weft ring woven in and closed, then the warp rings closed.
function assemblyMoves(strips, warpOnTop) {
  const [warp, weft] = ['warp', 'weft'].map((family) => strips.filter((strip) => strip.family === family));
  const over = (quad) => (warpOnTop[quad] === 0 ? 'over' : 'under');
  const lay = (strip, crossings) => ({ kind: 'lay', region: 0, strip: strip.id, pieces: strip.pieces, crossings });
  const close = (strip) => ({
    kind: 'close', region: 0, strip: strip.id, piece: strip.pieces.at(-1), onto: strip.pieces[0], end: 'end', where: 'in-place', crossing: strip.quads.at(-1), tucked: 0,
  });
  return [
    ...warp.map((strip) => lay(strip, [])),
    ...weft.flatMap((strip) => [lay(strip, strip.quads.map((quad, k) => [quad, warp[k].id, over(quad)])), close(strip)]),
    ...warp.map(close),
  ];
}

// Made-up figures of every quad, of the sort that quality.json has.
function qualityFile({ vertices, quads }) {
  const wave = (count, top) => Array.from({ length: count }, (_, k) => round(top * (1 + Math.sin(k / 7)), 4));
  return {
    format: 'leafcutter-quality/1', quads: quads.length, vertices: vertices.length,
    per_quad: { distance_percent: wave(quads.length, 0.2), area_percent: wave(quads.length, 0.3), planarity_percent: wave(quads.length, 1.1) },
    per_vertex: { angle_deviation_deg: wave(vertices.length, 1.9) },
  };
}

function leavesFile({ vertices }, { columns, rows }) {
  const at = (i, j) => vertices[(i % columns) * rows + (j % rows)].map((x) => round(x));
  const ring = (count, point) => Array.from({ length: count }, (_, k) => point(k));
  const weft = ring(rows, (j) => ({ family: 'weft', cylinder: 0, closed: true, points: ring(columns, (i) => at(i, j)) }));
  const warp = ring(columns, (i) => ({ family: 'warp', cylinder: 0, closed: true, points: ring(rows, (j) => at(i, j)) }));
  return { format: 'leafcutter-leaves/1', critical_graph: [], singularities: [], leaves: [...weft, ...warp] };
}

function surfacePly({ vertices, quads }) {
  const faces = quads.flatMap(([a, b, c, d]) => [`3 ${a} ${b} ${c}`, `3 ${a} ${c} ${d}`]);
  const head = ['ply', 'format ascii 1.0', `element vertex ${vertices.length}`, ...['x', 'y', 'z'].map((axis) => `property float64 ${axis}`)];
  return [...head, `element face ${faces.length}`, 'property list uint8 int32 vertex_indices', 'end_header', ...vertices.map((p) => p.join(' ')), ...faces, ''].join('\n');
}

// → { files: Map path → text, sheets: [{id, material, programSha256}], counts }
export function torusPackage({ name = 'torus', major = 95, minor = 38, columns = 48, rows = 20 } = {}) {
  const counts = { columns, rows };
  const mesh = torusQuads({ major, minor, columns, rows });
  const strips = weaveStrips(counts);
  const pieces = makePieces(mesh, strips, { weft: 4, warp: 1 });
  const byFamily = (letter) => pieces.filter((piece) => piece.id.startsWith(letter));
  const weft = nestFamily(byFamily('W'), 'weft', 1);
  const sheets = [...weft, ...nestFamily(byFamily('P'), 'warp', weft.length + 1)];
  const layout = { format: 'leafcutter-layout/1', sheets, density_percent: 71.4, unplaced: [] };
  const warpOnTop = mesh.quads.map((_, q) => (Math.floor(q / rows) + (q % rows)) % 2);
  const byId = new Map(pieces.map((piece) => [piece.id, piece]));
  const json = (value) => JSON.stringify(value);
  const files = new Map([
    ['report.json', json(report(mesh, layout, counts))],
    ['quads.obj', [...mesh.vertices.map((p) => `v ${p.map((x) => round(x, 6)).join(' ')}`), 'g cylinder_0', ...mesh.quads.map((q) => `f ${q.map((v) => v + 1).join(' ')}`), ''].join('\n')],
    ['strips.json', json({ format: 'leafcutter-strips/1', strips, pieces })],
    ['weave.json', json({
      format: 'leafcutter-weave/1', warp_on_top: warpOnTop, seams: [],
      regions: [{ cylinders: [0], part: 0, base: 'warp' }], moves: assemblyMoves(strips, warpOnTop),
    })],
    ['quality.json', json(qualityFile(mesh))],
    ['leaves.json', json(leavesFile(mesh, counts))],
    ['surface.ply', surfacePly(mesh)],
    ['layout.json', json(layout)],
    ['guide.html', '<!doctype html><title>Guide</title><p>Assembly guide.</p>'],
  ]);
  const programs = sheets.map((sheet) => {
    const paths = sheetPaths(sheet, byId);
    const stem = `sheets/sheet-${String(sheet.id).padStart(3, '0')}`;
    const gcode = writeGcode(sheet, paths, name);
    files.set(`${stem}.svg`, writeSvg(sheet, paths));
    files.set(`${stem}.gcode`, gcode);
    return { id: sheet.id, material: sheet.material, programSha256: createHash('sha256').update(gcode).digest('hex'), gcode };
  });
  return { files, programs, counts: { quads: mesh.quads.length, strips: strips.length, pieces: pieces.length, sheets: sheets.length } };
}
