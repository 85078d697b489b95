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
