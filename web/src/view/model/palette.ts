// The colours of the page's scheme, for 3D views.

export interface Palette {
  readonly weft: string;
  readonly warp: string;
  readonly surface: string;
  readonly line: string;
  readonly ghost: string; // Of what is not woven yet.
  readonly mark: string;
  readonly critical: string;
}

export function palette(element: Element): Palette {
  const style = getComputedStyle(element);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  return {
    weft: colour('--weft'),
    warp: colour('--warp'),
    surface: colour('--model-surface'),
    line: colour('--model-line'),
    ghost: colour('--model-ghost'),
    mark: colour('--mark'),
    critical: colour('--critical'),
  };
}
