// The woven model with its thickness, as the package's woven.glb holds it: binary glTF 2.0, one node per
// strip. Reads what Leafcutter writes (glTF specification, section 4), not every glTF file.

import { fields, type Fields, list, number, oneOf, optional, PayloadError, record, text } from '../lib/check.ts';
import type { Family } from './package_files.ts';

const kMagic = 0x46546c67; // "glTF"
const kJsonChunk = 0x4e4f534a;
const kByteChunk = 0x004e4942;
const kFloat = 5126;
const kUnsignedShort = 5123;
const kUnsignedInt = 5125;
const kMmPerMetre = 1000;

export interface SolidStrip {
  readonly id: string;
  readonly family: Family;
  readonly positions: Float32Array; // x y z per vertex, mm; z up as in the other files.
  readonly indices: Uint32Array; // Three per triangle, counter-clockwise from outside.
}

// Light, as shaders want it: red, green, blue from 0 to 1.
export type Light = readonly [number, number, number];

export interface SolidModel {
  readonly strips: readonly SolidStrip[];
  readonly colours: Readonly<Record<Family, Light>>;
}

interface Chunks {
  readonly json: Fields;
  readonly bytes: DataView;
}

function refuse(what: string): never {
  throw new PayloadError(`woven.glb: ${what}`);
}

function chunksOf(buffer: ArrayBuffer): Chunks {
  const view = new DataView(buffer);
  if (view.byteLength < 20 || view.getUint32(0, true) !== kMagic) refuse('no binary glTF');
  let json: Fields | undefined;
  let bytes = new DataView(new ArrayBuffer(0));
  for (let at = 12; at + 8 <= view.byteLength; ) {
    const length = view.getUint32(at, true);
    const kind = view.getUint32(at + 4, true);
    if (at + 8 + length > view.byteLength) refuse('ends too early');
    if (kind === kJsonChunk) json = fields(JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, at + 8, length))), 'woven.glb');
    if (kind === kByteChunk) bytes = new DataView(buffer, at + 8, length);
    at += 8 + length;
  }
  return { json: json ?? refuse('no JSON'), bytes };
}

class GlbReader {
  constructor(private readonly chunks: Chunks) {}

  items(name: string): readonly Fields[] {
    return record(this.chunks.json, '')(name, optional(list(fields), []));
  }

  private item(name: string, index: number): Fields {
    return this.items(name)[index] ?? refuse(`no ${name} ${index}`);
  }

  // The numbers of an accessor, `width` to an element, as `read` finds them at a byte.
  private numbers(index: number, width: number, kinds: readonly number[]): { count: number; kind: number; at: number; bytes: DataView } {
    const accessor = record(this.item('accessors', index), `accessors/${index}`);
    const kind = accessor('componentType', number);
    if (!kinds.includes(kind)) refuse(`component type ${kind}`);
    const count = width * accessor('count', number);
    const view = record(this.item('bufferViews', accessor('bufferView', number)), 'bufferViews');
    const at = view('byteOffset', optional(number, 0)) + accessor('byteOffset', optional(number, 0));
    const size = kind === kUnsignedShort ? 2 : 4;
    if (at + count * size > this.chunks.bytes.byteLength) refuse('bytes are missing');
    return { count, kind, at, bytes: this.chunks.bytes };
  }

  positions(index: number): Float32Array {
    const { count, at, bytes } = this.numbers(index, 3, [kFloat]);
    return Float32Array.from({ length: count }, (_, i) => kMmPerMetre * bytes.getFloat32(at + 4 * i, true));
  }

  indices(index: number): Uint32Array {
    const { count, kind, at, bytes } = this.numbers(index, 1, [kUnsignedShort, kUnsignedInt]);
    return Uint32Array.from({ length: count }, (_, i) =>
      kind === kUnsignedShort ? bytes.getUint16(at + 2 * i, true) : bytes.getUint32(at + 4 * i, true),
    );
  }

  strip(node: Fields): SolidStrip {
    const get = record(node, 'nodes');
    const mesh = this.item('meshes', get('mesh', number));
    const [primitive] = record(mesh, 'meshes')('primitives', list(fields));
    const of = record(primitive ?? refuse('a mesh without triangles'), 'primitives');
    const attributes = record(of('attributes', fields), 'attributes');
    return {
      id: get('name', text),
      family: record(get('extras', fields), 'extras')('family', oneOf<Family>('weft', 'warp')),
      positions: this.positions(attributes('POSITION', number)),
      indices: this.indices(of('indices', number)),
    };
  }

  colour(name: Family): Light {
    const material = this.items('materials').find((item) => item['name'] === name) ?? refuse(`no material ${name}`);
    const surface = record(record(material, name)('pbrMetallicRoughness', fields), name);
    const [red, green, blue] = surface('baseColorFactor', list(number));
    return [red ?? 0, green ?? 0, blue ?? 0];
  }
}

export function readSolidModel(buffer: ArrayBuffer): SolidModel {
  const reader = new GlbReader(chunksOf(buffer));
  const nodes = reader.items('nodes').filter((node) => node['mesh'] !== undefined);
  return {
    strips: nodes.map((node) => reader.strip(node)),
    colours: { weft: reader.colour('weft'), warp: reader.colour('warp') },
  };
}
