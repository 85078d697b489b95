// A mesh as its file has it: OBJ, OFF, STL and PLY, for an instant look before anything is sent. The daemon
// reads the file anew and strictly; what this can't read it may still take.

export interface RawMesh {
  readonly positions: Float64Array; // x y z per vertex as numbered in the file.
  readonly triangles: Uint32Array; // Polygons are fanned out.
  readonly polygons: number; // Faces as the file has them.
}

export class MeshFault extends Error {
  override name = 'MeshFault';
}

const kMostVertices = 20_000_000;

class Builder {
  readonly xyz: number[] = [];
  readonly corners: number[] = [];
  polygons = 0;

  vertex(x: number, y: number, z: number): void {
    if (!Number.isFinite(x) || !Number.isFinite(y) || !Number.isFinite(z)) throw new MeshFault(`vertex ${this.xyz.length / 3}`);
    this.xyz.push(x, y, z);
  }

  face(vertices: readonly number[]): void {
    this.polygons += 1;
    const [first = 0] = vertices;
    for (let k = 1; k + 1 < vertices.length; k += 1) this.corners.push(first, vertices[k] ?? 0, vertices[k + 1] ?? 0);
  }

  done(): RawMesh {
    const count = this.xyz.length / 3;
    const wrong = this.corners.findIndex((vertex) => !(vertex >= 0 && vertex < count));
    if (wrong >= 0) throw new MeshFault(`face ${Math.floor(wrong / 3)}`);
    if (count === 0 || this.corners.length === 0) throw new MeshFault('empty');
    return {
      positions: Float64Array.from(this.xyz),
      triangles: Uint32Array.from(this.corners),
      polygons: this.polygons,
    };
  }
}

function readObj(text: string): RawMesh {
  const mesh = new Builder();
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') mesh.vertex(Number(words[1]), Number(words[2]), Number(words[3]));
    else if (words[0] === 'f') {
      const count = mesh.xyz.length / 3;
      mesh.face(
        words.slice(1).map((word) => {
          const number = Number.parseInt(word, 10);
          return number < 0 ? count + number : number - 1;
        }),
      );
    }
  }
  return mesh.done();
}

function readOff(text: string): RawMesh {
  const words = text.replace(/#[^\n]*/g, ' ').split(/\s+/).filter((word) => word !== '');
  let at = /OFF$/.test(words[0] ?? '') ? 1 : 0;
  const stride = /^(ST)?(C)?(N)?OFF$/.exec(words[0] ?? 'OFF');
  const next = (): number => Number(words[at++]);
  const [vertices, faces] = [next(), next()];
  next();
  if (!(vertices <= kMostVertices) || !(faces <= 2 * kMostVertices)) throw new MeshFault('header');
  const extra = (stride?.[3] === undefined ? 0 : 3) + (stride?.[2] === undefined ? 0 : 4) + (stride?.[1] === undefined ? 0 : 2);
  const mesh = new Builder();
  for (let v = 0; v < vertices; v += 1) {
    mesh.vertex(next(), next(), next());
    at += extra;
  }
  // Faces may end in colours, which only the line's end tells apart.
  const lines = text.replace(/#[^\n]*/g, '').split('\n').filter((line) => line.trim() !== '');
  for (const line of lines.slice(lines.length - faces)) {
    const numbers = line.trim().split(/\s+/).map(Number);
    mesh.face(numbers.slice(1, 1 + (numbers[0] ?? 0)));
  }
  return mesh.done();
}

function readTextStl(text: string): RawMesh {
  const mesh = new Builder();
  for (const match of text.matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/g)) {
    mesh.vertex(Number(match[1]), Number(match[2]), Number(match[3]));
  }
  for (let v = 0; v + 2 < mesh.xyz.length / 3; v += 3) mesh.face([v, v + 1, v + 2]);
  return mesh.done();
}

function readStl(bytes: ArrayBuffer): RawMesh {
  const view = new DataView(bytes);
  const count = bytes.byteLength >= 84 ? view.getUint32(80, true) : -1;
  if (bytes.byteLength !== 84 + 50 * count) return readTextStl(new TextDecoder().decode(bytes));
  const mesh = new Builder();
  for (let f = 0; f < count; f += 1) {
    for (let k = 0; k < 3; k += 1) {
      const at = 84 + 50 * f + 12 + 12 * k;
      mesh.vertex(view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true));
    }
    mesh.face([3 * f, 3 * f + 1, 3 * f + 2]);
  }
  return mesh.done();
}

const kSizes: Readonly<Record<string, number>> = {
  char: 1, uchar: 1, int8: 1, uint8: 1, short: 2, ushort: 2, int16: 2, uint16: 2,
  int: 4, uint: 4, int32: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8,
};

interface Property {
  readonly name: string;
  readonly type: string;
  readonly count: string | null; // Type of a list's length.
}

interface Element {
  readonly name: string;
  readonly count: number;
  readonly properties: Property[];
}

// The next number of a type: from text, or from bytes.
type Source = (type: string) => number;

function textSource(text: string): Source {
  const words = text.split(/\s+/).filter((word) => word !== '');
  let at = 0;
  return () => Number(words[at++]);
}

function byteSource(view: DataView, start: number, little: boolean): Source {
  let at = start;
  return (type) => {
    const here = at;
    at += kSizes[type] ?? 0;
    switch (type) {
      case 'char': case 'int8': return view.getInt8(here);
      case 'uchar': case 'uint8': return view.getUint8(here);
      case 'short': case 'int16': return view.getInt16(here, little);
      case 'ushort': case 'uint16': return view.getUint16(here, little);
      case 'int': case 'int32': return view.getInt32(here, little);
      case 'uint': case 'uint32': return view.getUint32(here, little);
      case 'float': case 'float32': return view.getFloat32(here, little);
      case 'double': case 'float64': return view.getFloat64(here, little);
      default: throw new MeshFault('header');
    }
  };
}

function plyHeader(head: string): { readonly format: string; readonly elements: readonly Element[] } {
  let format = '';
  const elements: Element[] = [];
  for (const line of head.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'format') format = words[1] ?? '';
    else if (words[0] === 'element') elements.push({ name: words[1] ?? '', count: Number(words[2]), properties: [] });
    else if (words[0] === 'property') {
      const isList = words[1] === 'list';
      const property = isList
        ? { name: words[4] ?? '', type: words[3] ?? '', count: words[2] ?? '' }
        : { name: words[2] ?? '', type: words[1] ?? '', count: null };
      elements.at(-1)?.properties.push(property);
    }
  }
  return { format, elements };
}

function readElement(element: Element, next: Source, mesh: Builder): void {
  for (let k = 0; k < element.count; k += 1) {
    const values: Record<string, number> = {};
    let corners: number[] = [];
    for (const property of element.properties) {
      if (property.count === null) values[property.name] = next(property.type);
      else {
        const length = next(property.count);
        if (!(length >= 0 && length < 100_000)) throw new MeshFault(`face ${k}`);
        const list = Array.from({ length }, () => next(property.type));
        if (/^vertex_ind/.test(property.name)) corners = list;
      }
    }
    if (element.name === 'vertex') mesh.vertex(values['x'] ?? Number.NaN, values['y'] ?? Number.NaN, values['z'] ?? Number.NaN);
    else if (element.name === 'face') mesh.face(corners);
  }
}

function readPly(bytes: ArrayBuffer): RawMesh {
  const start = new TextDecoder('latin1').decode(bytes.slice(0, 16_384));
  const end = /end_header\r?\n/.exec(start);
  if (end === null) throw new MeshFault('header');
  const body = end.index + end[0].length;
  const { format, elements } = plyHeader(start.slice(0, end.index));
  if (elements.some(({ count }) => !(count <= 2 * kMostVertices))) throw new MeshFault('header');
  const source =
    format === 'ascii'
      ? textSource(new TextDecoder().decode(bytes.slice(body)))
      : byteSource(new DataView(bytes), body, format === 'binary_little_endian');
  const mesh = new Builder();
  for (const element of elements) readElement(element, source, mesh);
  return mesh.done();
}

// Throws a MeshFault whose message says where. `name` tells the format.
export function readMesh(name: string, bytes: ArrayBuffer): RawMesh {
  const text = (): string => new TextDecoder().decode(bytes);
  const ending = name.toLowerCase().split('.').at(-1);
  try {
    if (ending === 'obj') return readObj(text());
    if (ending === 'off') return readOff(text());
    if (ending === 'stl') return readStl(bytes);
    if (ending === 'ply') return readPly(bytes);
  } catch (fault) {
    throw fault instanceof MeshFault ? fault : new MeshFault('truncated');
  }
  throw new MeshFault('format');
}
