// Reading unknown JSON: each reader either returns a value of its type or throws a PayloadError that
// names the path at fault. Fields that are not asked for are ignored.

export class PayloadError extends Error {
  override name = 'PayloadError';
}

export type Reader<T> = (value: unknown, path: string) => T;

function refuse(path: string, wanted: string): never {
  throw new PayloadError(`${path || 'payload'}: expected ${wanted}`);
}

export const text: Reader<string> = (value, path) =>
  typeof value === 'string' ? value : refuse(path, 'a string');

export const number: Reader<number> = (value, path) =>
  typeof value === 'number' && Number.isFinite(value) ? value : refuse(path, 'a finite number');

export const flag: Reader<boolean> = (value, path) =>
  typeof value === 'boolean' ? value : refuse(path, 'true or false');

export type Fields = Readonly<Record<string, unknown>>;

export const fields: Reader<Fields> = (value, path) =>
  typeof value === 'object' && value !== null && !Array.isArray(value)
    ? (value as Fields)
    : refuse(path, 'an object');

export const list =
  <T>(item: Reader<T>): Reader<readonly T[]> =>
  (value, path) =>
    Array.isArray(value)
      ? value.map((entry: unknown, index) => item(entry, `${path}/${index}`))
      : refuse(path, 'a list');

export const oneOf =
  <T extends string>(...allowed: readonly T[]): Reader<T> =>
  (value, path) =>
    allowed.find((name) => name === value) ?? refuse(path, allowed.join(' or '));

// Absent and null read as `otherwise`.
export const optional =
  <T, U>(reader: Reader<T>, otherwise: U): Reader<T | U> =>
  (value, path) =>
    value === undefined || value === null ? otherwise : reader(value, path);

export const point: Reader<readonly [number, number]> = (value, path) => {
  if (!Array.isArray(value) || value.length < 2) return refuse(path, 'a point [x, y]');
  return [number(value[0], `${path}/0`), number(value[1], `${path}/1`)];
};

// Reads the fields of one object: `get('name', text)`. With the type that the daemon's description has for
// it, as record<Schema>, no other key than the described ones can be asked for.
export function record<Wire = Record<string, unknown>>(
  value: unknown,
  path: string,
): <T>(key: keyof Wire & string, reader: Reader<T>) => T {
  const object = fields(value, path);
  return (key, reader) => reader(object[key], `${path}/${key}`);
}
