// A small picture of a weave: each crossing shows which family lies on top.

const kCell = 10;
const kWidth = 7.6;

// Rows of weft by columns of warp, 1 where warp is on top; repeated to `size` × `size` crossings.
export function Swatch(props: { readonly repeat: readonly (readonly number[])[]; readonly size: number }) {
  const { repeat, size } = props;
  const side = size * kCell;
  const inset = (kCell - kWidth) / 2;
  const crossings = Array.from({ length: size * size }, (_, k) => ({ row: Math.floor(k / size), column: k % size }));
  const warpOnTop = (row: number, column: number): boolean => {
    const line = repeat[row % repeat.length] ?? [];
    return line[column % line.length] === 1;
  };
  return (
    <svg class="swatch" viewBox={`0 0 ${side} ${side}`} aria-hidden="true">
      <rect class="swatch-ground" width={side} height={side} />
      {Array.from({ length: size }, (_, row) => (
        <rect key={row} class="swatch-weft" x={0} y={row * kCell + inset} width={side} height={kWidth} />
      ))}
      {crossings.map(({ row, column }) => (
        <g key={`${row}/${column}`} transform={`translate(${column * kCell} ${row * kCell})`}>
          {warpOnTop(row, column) ? (
            <rect class="swatch-warp" x={inset} y={-0.6} width={kWidth} height={kCell + 1.2} />
          ) : (
            <path class="swatch-under" d={`M${inset} 0v${inset}h${kWidth}v${-inset}zM${inset} ${kCell}v${-inset}h${kWidth}v${inset}z`} />
          )}
        </g>
      ))}
    </svg>
  );
}
