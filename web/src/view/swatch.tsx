// A small picture of a weave: each crossing shows which family lies on top.

const kCell = 10;
const kWidth = 7.6;

const kInset = (kCell - kWidth) / 2;

// Warp over weft; weft is shaded where it dives under.
function WarpOver() {
  const shade = `M0 ${kInset}h${kInset}v${kWidth}h${-kInset}zM${kCell - kInset} ${kInset}h${kInset}v${kWidth}h${-kInset}z`;
  return (
    <>
      <path class="swatch-shade" d={shade} />
      <rect class="swatch-warp" x={kInset} y={-0.05} width={kWidth} height={kCell + 0.1} />
    </>
  );
}

// Warp under weft: only its shaded ends are seen.
function WarpUnder() {
  const ends = `M${kInset} -0.05h${kWidth}v${kInset}h${-kWidth}zM${kInset} ${kCell - kInset}h${kWidth}v${kInset}h${-kWidth}z`;
  return (
    <>
      <path class="swatch-warp" d={ends} />
      <path class="swatch-shade" d={ends} />
    </>
  );
}

// Rows of weft by columns of warp, 1 where warp is on top; repeated to fill the picture.
export function Swatch(props: {
  readonly repeat: readonly (readonly number[])[];
  readonly rows: number;
  readonly columns: number;
  readonly woven?: number; // Columns that have their warp already; all, if not given.
}) {
  const { repeat, rows, columns, woven = columns } = props;
  const [width, height] = [columns * kCell, rows * kCell];
  const crossings = Array.from({ length: rows * woven }, (_, k) => ({ row: k % rows, column: Math.floor(k / rows) }));
  const warpOnTop = (row: number, column: number): boolean => {
    const line = repeat[row % repeat.length] ?? [];
    return line[column % line.length] === 1;
  };
  return (
    <svg class="swatch" viewBox={`0 0 ${width} ${height}`} preserveAspectRatio="xMidYMid slice" aria-hidden="true">
      <rect class="swatch-ground" width={width} height={height} />
      {Array.from({ length: rows }, (_, row) => (
        <rect key={row} class="swatch-weft" x={0} y={row * kCell + kInset} width={width} height={kWidth} />
      ))}
      {crossings.map(({ row, column }) => (
        <g key={`${row}/${column}`} transform={`translate(${column * kCell} ${row * kCell})`}>
          {warpOnTop(row, column) ? <WarpOver /> : <WarpUnder />}
        </g>
      ))}
    </svg>
  );
}
