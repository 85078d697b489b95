// A torus as an OFF file: closed, oriented, small.
export function torusOff({ major = 1, minor = 0.4, columns = 48, rows = 20 } = {}) {
  const vertices = [];
  const faces = [];
  const vertex = (i, j) => (i % columns) * rows + (j % rows);
  for (let i = 0; i < columns; i += 1) {
    for (let j = 0; j < rows; j += 1) {
      const [u, v] = [(2 * Math.PI * i) / columns, (2 * Math.PI * j) / rows];
      const reach = major + minor * Math.cos(v);
      vertices.push(`${reach * Math.cos(u)} ${reach * Math.sin(u)} ${minor * Math.sin(v)}`);
      const [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
      faces.push(`3 ${a} ${b} ${c}`, `3 ${a} ${c} ${d}`);
    }
  }
  return `OFF\n${vertices.length} ${faces.length} 0\n${vertices.join('\n')}\n${faces.join('\n')}\n`;
}

// A block of cubes with two holes right through it, as an OFF file: genus 2. Each cube has an edge of 1, its
// faces are cut into 2 × `fine` × `fine` triangles.
export function twoHolesOff({ fine = 4 } = {}) {
  const [wide, deep] = [7, 3];
  const isCube = (x, y, z) => z === 0 && x >= 0 && x < wide && y >= 0 && y < deep && !(y === 1 && (x === 1 || x === 5));
  const numbers = new Map();
  const faces = [];
  const vertex = (at) => {
    const key = at.join(' ');
    if (!numbers.has(key)) numbers.set(key, numbers.size);
    return numbers.get(key);
  };
  const face = (corner, along, across) => {
    const at = (i, j) => vertex(corner.map((c, k) => c * fine + i * along[k] + j * across[k]));
    for (let i = 0; i < fine; i += 1) {
      for (let j = 0; j < fine; j += 1) {
        const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        faces.push(`3 ${a} ${b} ${c}`, `3 ${a} ${c} ${d}`);
      }
    }
  };
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let x = 0; x < wide; x += 1) {
    for (let y = 0; y < deep; y += 1) {
      if (!isCube(x, y, 0)) continue;
      for (const [k, out] of axes.entries()) {
        const [along, across] = [axes[(k + 1) % 3], axes[(k + 2) % 3]];
        if (!isCube(x + out[0], y + out[1], out[2])) face([x + out[0], y + out[1], out[2]], along, across);
        if (!isCube(x - out[0], y - out[1], -out[2])) face([x, y, 0], across, along);
      }
    }
  }
  return `OFF\n${numbers.size} ${faces.length} 0\n${[...numbers.keys()].join('\n')}\n${faces.join('\n')}\n`;
}
