// The words of the job parameters for how a surface is laid out.

// How the surface is foliated: the words of the job parameters, the daemon's own choice first.
export const kModes = [
  'auto',
  'pants',
  'one-form',
  'disk',
  'annulus',
  'torus',
  'sphere-pillowcase',
  'sphere-polar',
] as const;
export type FoliationMode = (typeof kModes)[number];
export const kPantsSources = ['reeb', 'handle-loops', 'tunnel-loops', 'user'] as const;
export type PantsSource = (typeof kPantsSources)[number];
export const kSweepFunctions = ['auto', 'harmonic', 'x', 'y', 'z', 'fiedler'] as const;
export type SweepFunction = (typeof kSweepFunctions)[number];
export const kPunctures = ['auto', 'none'] as const;
export type Punctures = (typeof kPunctures)[number];
export const kComponents = ['each', 'largest'] as const;
export type Components = (typeof kComponents)[number];

// Whether the surface may be cut into pairs of pants in this mode.
export function usesPants(mode: FoliationMode): boolean {
  return mode === 'auto' || mode === 'pants';
}

// Whether the leaves can have singular points in this mode.
export function usesPlaces(mode: FoliationMode): boolean {
  return mode !== 'disk' && mode !== 'annulus' && mode !== 'torus';
}
