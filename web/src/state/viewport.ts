// The part of a sheet that is looked at, in sheet millimetres as drawn (y down).

export interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

const kMostZoom = 60;

function limit(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

// The whole sheet with a little air around it.
export function fit(sheet: Box): Box {
  const air = 0.02 * Math.max(sheet.width, sheet.height);
  return { x: sheet.x - air, y: sheet.y - air, width: sheet.width + 2 * air, height: sheet.height + 2 * air };
}

// Keeps the middle of the view on the sheet, so that it can't be lost.
function hold(view: Box, sheet: Box): Box {
  const x = limit(view.x + view.width / 2, sheet.x, sheet.x + sheet.width) - view.width / 2;
  const y = limit(view.y + view.height / 2, sheet.y, sheet.y + sheet.height) - view.height / 2;
  return { ...view, x, y };
}

// Zooms in by `factor` (out if < 1); the point (x, y) stays where it is on the screen.
export function zoomAt(view: Box, sheet: Box, at: { readonly x: number; readonly y: number }, factor: number): Box {
  const whole = fit(sheet);
  const width = limit(view.width / factor, whole.width / kMostZoom, whole.width);
  if (width === whole.width) return whole;
  const applied = view.width / width;
  return hold(
    {
      x: at.x - (at.x - view.x) / applied,
      y: at.y - (at.y - view.y) / applied,
      width,
      height: view.height / applied,
    },
    sheet,
  );
}

export function panBy(view: Box, sheet: Box, dx: number, dy: number): Box {
  return hold({ ...view, x: view.x + dx, y: view.y + dy }, sheet);
}

export function centre(view: Box): { x: number; y: number } {
  return { x: view.x + view.width / 2, y: view.y + view.height / 2 };
}
