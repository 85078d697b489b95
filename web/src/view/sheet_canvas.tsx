// One sheet as a drawing that can be zoomed and moved, with what is already burnt on top.

import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';

import { t } from '../messages/messages.ts';
import type { Burnt } from '../state/burn.ts';
import { chooseStrip, chosenStrip, pointedStrip } from '../state/package_store.ts';
import type { Label, SheetDrawing } from '../state/sheets.ts';
import { type Box, centre, fit, panBy, zoomAt } from '../state/viewport.ts';
import { ZoomButtons } from './zoom_buttons.tsx';

function stripUnder(event: Event): string | null {
  const target = event.target instanceof Element ? event.target.closest('[data-strip]') : null;
  return target?.getAttribute('data-strip') ?? null;
}

// Labels are only drawn where they can be read.
const kReadableViewMm = 330;

function LabelText(props: { readonly label: Label }) {
  const { text, at, angleDeg, heightMm } = props.label;
  const transform = `translate(${at[0]} ${at[1]}) rotate(${angleDeg}) scale(1 -1)`;
  // A capital is about 0.72 of the font's size.
  return (
    <text class="label" transform={transform} font-size={heightMm / 0.72}>
      {text}
    </text>
  );
}

function Pieces(props: { readonly sheet: SheetDrawing; readonly labels: boolean }) {
  const pointed = pointedStrip.value;
  const chosen = chosenStrip.value;
  const shade = (strip: string): string => (strip === chosen ? 'chosen' : strip === pointed ? 'pointed' : '');
  return (
    <>
      {props.sheet.pieces.map((piece) => (
        <g key={piece.piece} class={`piece ${piece.family} ${shade(piece.strip)}`} data-strip={piece.strip}>
          <path class="outline" d={piece.outline} />
          {piece.marks !== '' && <path class="marks" d={piece.marks} />}
          {props.labels && piece.labels.map((label) => <LabelText key={`${label.text}${label.at.join()}`} label={label} />)}
        </g>
      ))}
    </>
  );
}

function Burn(props: { readonly burnt: Burnt; readonly hot: boolean; readonly scale: number }) {
  const { burnt, hot, scale } = props;
  return (
    <g class="burn">
      {burnt.chunks.map((data, index) => (
        <path key={index} d={data} />
      ))}
      <path d={burnt.growing} />
      {hot && burnt.beam !== null && (
        <g class="beam" transform={`translate(${burnt.beam[0]} ${burnt.beam[1]}) scale(${scale})`}>
          <circle class="glow" r={5} />
          <circle class="core" r={1.8} />
        </g>
      )}
    </g>
  );
}

// Sheet coordinates of a point on the screen, in the drawing's own y-down frame.
function toSheet(svg: SVGSVGElement, clientX: number, clientY: number): { x: number; y: number } {
  const matrix = svg.getScreenCTM();
  if (matrix === null) return { x: 0, y: 0 };
  const at = new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
  return { x: at.x, y: at.y };
}

interface Finger {
  readonly x: number;
  readonly y: number;
}

// Dragging with one pointer, pinching with two, and the wheel once the drawing has the focus.
function useGestures(sheet: Box, change: (edit: (view: Box) => Box) => void) {
  const svg = useRef<SVGSVGElement | null>(null);
  const fingers = useRef(new Map<number, Finger>());
  const dragged = useRef(false);

  useEffect(() => {
    const element = svg.current;
    const onWheel = (event: WheelEvent): void => {
      if (element === null || (!event.ctrlKey && document.activeElement !== element)) return;
      event.preventDefault();
      const at = toSheet(element, event.clientX, event.clientY);
      change((view) => zoomAt(view, sheet, at, Math.exp(-event.deltaY * 0.0022)));
    };
    element?.addEventListener('wheel', onWheel, { passive: false });
    return () => element?.removeEventListener('wheel', onWheel);
  }, [sheet, change]);

  function moved(event: PointerEvent, from: Finger, element: SVGSVGElement): void {
    const before = toSheet(element, from.x, from.y);
    const after = toSheet(element, event.clientX, event.clientY);
    const other = [...fingers.current.entries()].find(([id]) => id !== event.pointerId)?.[1];
    if (other === undefined) {
      change((view) => panBy(view, sheet, before.x - after.x, before.y - after.y));
      return;
    }
    const spread = (to: Finger): number => Math.hypot(to.x - other.x, to.y - other.y) || 1;
    const factor = spread({ x: event.clientX, y: event.clientY }) / spread(from);
    change((view) => zoomAt(view, sheet, toSheet(element, other.x, other.y), factor));
  }

  const handlers = {
    onPointerDown: (event: PointerEvent) => {
      fingers.current.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (fingers.current.size === 1) dragged.current = false;
    },
    onPointerMove: (event: PointerEvent) => {
      const from = fingers.current.get(event.pointerId);
      const element = svg.current;
      if (from === undefined || element === null) {
        pointedStrip.value = stripUnder(event);
        return;
      }
      if (!dragged.current && Math.hypot(event.clientX - from.x, event.clientY - from.y) < 4) return;
      dragged.current = true;
      element.setPointerCapture(event.pointerId);
      moved(event, from, element);
      fingers.current.set(event.pointerId, { x: event.clientX, y: event.clientY });
    },
    onPointerUp: (event: PointerEvent) => {
      fingers.current.delete(event.pointerId);
      if (dragged.current) return;
      const strip = stripUnder(event);
      chooseStrip(strip === chosenStrip.value ? null : strip);
    },
    onPointerCancel: (event: PointerEvent) => fingers.current.delete(event.pointerId),
    onPointerLeave: () => (pointedStrip.value = null),
  };
  return { svg, handlers };
}

function editByKey(event: KeyboardEvent, sheet: Box): ((view: Box) => Box) | null {
  const pan = (dx: number, dy: number) => (view: Box) => panBy(view, sheet, dx * view.width, dy * view.height);
  const zoom = (factor: number) => (view: Box) => zoomAt(view, sheet, centre(view), factor);
  const edits: Readonly<Record<string, (view: Box) => Box>> = {
    ArrowLeft: pan(-0.1, 0),
    ArrowRight: pan(0.1, 0),
    ArrowUp: pan(0, -0.1),
    ArrowDown: pan(0, 0.1),
    '+': zoom(1.3),
    '=': zoom(1.3),
    '-': zoom(1 / 1.3),
    Home: () => fit(sheet),
  };
  return event.ctrlKey || event.metaKey ? null : (edits[event.key] ?? null);
}

export function SheetCanvas(props: {
  readonly sheet: SheetDrawing;
  readonly burnt: Burnt | null;
  readonly hot: boolean;
  readonly about: ComponentChildren; // Said below the drawing.
  readonly over?: ComponentChildren; // Lies over it.
  readonly children?: ComponentChildren; // Buttons beside those for zooming.
}) {
  const { sheet, burnt, hot } = props;
  const box = useMemo(() => ({ x: 0, y: 0, width: sheet.widthMm, height: sheet.heightMm }), [sheet]);
  const [view, setView] = useState(() => fit(box));
  useEffect(() => setView(fit(box)), [box]);
  const { svg, handlers } = useGestures(box, setView);
  const zoom = (factor: number): void => setView(zoomAt(view, box, centre(view), factor));
  const labels = view.width < kReadableViewMm;
  // Kept as it is while a cut's progress draws the rest several times a second.
  const pieces = useMemo(() => <Pieces sheet={sheet} labels={labels} />, [sheet, labels]);
  const whole = view.width >= fit(box).width;
  return (
    <>
      <div class="view">
      <svg
        ref={svg}
        class={whole ? 'sheet whole' : 'sheet'}
        viewBox={`${view.x} ${view.y} ${view.width} ${view.height}`}
        role="img"
        tabindex={0}
        aria-label={t.sheets.label(sheet.id, sheet.pieces.length)}
        onKeyDown={(event) => {
          const edit = editByKey(event, box);
          if (edit === null) return;
          event.preventDefault();
          setView(edit);
        }}
        {...handlers}
      >
        <rect class="paper" width={sheet.widthMm} height={sheet.heightMm} />
        <g transform={`translate(0 ${sheet.heightMm}) scale(1 -1)`}>
          {pieces}
          {burnt !== null && <Burn burnt={burnt} hot={hot} scale={view.width / 400} />}
        </g>
      </svg>
      {props.over}
      </div>
      <div class="view-foot">
        {props.about}
        <span class="view-buttons">
          {props.children}
          <ZoomButtons fitLabel={t.sheets.fit} onZoom={zoom} onFit={() => setView(fit(box))} />
        </span>
      </div>
    </>
  );
}
