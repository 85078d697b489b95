// Draws the outline of a remnant: corners are dragged, or moved with the arrow keys; a side gets a new corner at
// its middle; Delete takes one away.

import { useRef, useState } from 'preact/hooks';

import type { Point } from '../../api/package_files.ts';
import { figure } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { dropCorner, kFewest, middle, moveCorner, type Outline, splitSide } from '../../state/outline.ts';
import { pathData } from '../../state/sheets.ts';
import { numberOf, TextField } from '../fields.tsx';

const kArrows: Readonly<Record<string, Point>> = {
  ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0],
};
const kBigStep = 10; // mm, with Shift.

interface Props {
  readonly outline: Outline;
  readonly sheet: Point; // Width and height of what it is drawn on.
  readonly onChange: (outline: Outline) => void;
}

// Where on the sheet a pointer is.
function placeOf(svg: SVGSVGElement, event: PointerEvent): Point {
  const matrix = svg.getScreenCTM();
  if (matrix === null) return [0, 0];
  const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
  return [x, -y];
}

function Corner(props: { readonly at: Point; readonly size: number; readonly label: string; readonly kind: string } & {
  readonly onPress?: () => void;
  readonly onFocus?: () => void;
  readonly onKey?: (event: KeyboardEvent) => void;
  readonly onUse?: () => void;
}) {
  const { at, size, label, kind, onPress, onFocus, onKey, onUse } = props;
  return (
    <g
      class={`outline-${kind}`}
      role="button"
      tabindex={0}
      aria-label={label}
      transform={`translate(${at[0]} ${-at[1]})`}
      onPointerDown={onPress}
      onFocus={onFocus}
      onClick={onUse}
      onKeyDown={(event) => {
        if (onUse !== undefined && (event.key === 'Enter' || event.key === ' ')) {
          event.preventDefault();
          onUse();
        }
        onKey?.(event);
      }}
    >
      <circle class="outline-reach" r={2 * size} />
      <circle r={kind === 'side' ? 0.6 * size : size} />
    </g>
  );
}

function Coordinates(props: Props & { readonly index: number }) {
  const { outline, sheet, index, onChange } = props;
  const [x, y] = outline[index] ?? [0, 0];
  const typed = (axis: 0 | 1) => (value: string): void => {
    const number = numberOf(value);
    if (number !== null) onChange(moveCorner(outline, index, axis === 0 ? [number, y] : [x, number], sheet));
  };
  return (
    <div class="measures">
      <TextField label={`${t.stock.outline.corner(String(index + 1))}, X`} value={String(x)} unit="mm" decimal onInput={typed(0)} />
      <TextField label={`${t.stock.outline.corner(String(index + 1))}, Y`} value={String(y)} unit="mm" decimal onInput={typed(1)} />
      <button type="button" class="button" disabled={outline.length <= kFewest} onClick={() => onChange(dropCorner(outline, index))}>
        {t.stock.outline.drop}
      </button>
    </div>
  );
}

export function OutlineEditor(props: Props) {
  const { outline, sheet, onChange } = props;
  const svg = useRef<SVGSVGElement>(null);
  const held = useRef<number | null>(null);
  const [chosen, setChosen] = useState(0);
  const [width, height] = sheet;
  const size = 0.018 * Math.max(width, height);
  const margin = 3 * size;
  const index = Math.min(chosen, outline.length - 1);
  const key = (at: number) => (event: KeyboardEvent): void => {
    const arrow = kArrows[event.key];
    const corner = outline[at];
    if (corner === undefined || (arrow === undefined && event.key !== 'Delete')) return;
    event.preventDefault();
    const step = event.shiftKey ? kBigStep : 1;
    if (arrow === undefined) onChange(dropCorner(outline, at));
    else onChange(moveCorner(outline, at, [corner[0] + step * arrow[0], corner[1] + step * arrow[1]], sheet));
  };
  const drag = (event: PointerEvent): void => {
    if (held.current === null || svg.current === null) return;
    onChange(moveCorner(outline, held.current, placeOf(svg.current, event), sheet));
  };
  const letGo = (): void => void (held.current = null);
  return (
    <div class="outline-editor">
      <p class="quiet">{t.stock.outline.hint}</p>
      <svg
        ref={svg}
        role="group"
        aria-label={t.stock.outline.label}
        viewBox={`${-margin} ${-height - margin} ${width + 2 * margin} ${height + 2 * margin}`}
        onPointerDown={(event) => held.current !== null && svg.current?.setPointerCapture(event.pointerId)}
        onPointerMove={drag}
        onPointerUp={letGo}
        onPointerCancel={letGo}
      >
        <rect class="outline-sheet" y={-height} width={width} height={height} />
        <path class="outline-path" transform="scale(1 -1)" d={`${pathData(outline)}Z`} />
        {outline.map((_, k) => (
          <Corner
            key={`side${k}`}
            kind="side"
            at={middle(outline, k)}
            size={size}
            label={t.stock.outline.split(String(k + 1))}
            onUse={() => {
              onChange(splitSide(outline, k));
              setChosen(k + 1);
            }}
          />
        ))}
        {outline.map((at, k) => (
          <Corner
            key={`corner${k}`}
            kind={k === index ? 'corner chosen' : 'corner'}
            at={at}
            size={size}
            label={`${t.stock.outline.corner(String(k + 1))}: ${figure(at[0], 5)}, ${figure(at[1], 5)} mm`}
            onPress={() => {
              held.current = k;
              setChosen(k);
            }}
            onFocus={() => setChosen(k)}
            onKey={key(k)}
          />
        ))}
      </svg>
      <Coordinates {...props} index={index} />
    </div>
  );
}
