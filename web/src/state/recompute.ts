// Weaving a job's mesh once more, laid out as one of the alternatives that were looked at.

import { type FoliationMode, kModes } from './foliation_choices.ts';

type Params = Readonly<Record<string, unknown>>;

export function modeNamed(name: string): FoliationMode | null {
  return kModes.find((mode) => mode === name && mode !== 'auto') ?? null;
}

// The parameters of the job with the mode of that name; null where the name is more than a mode. What
// else was said of the foliation belonged to the old mode, but for which parts are woven.
export function alternativeParams(params: Params, name: string): Params | null {
  const mode = modeNamed(name);
  if (mode === null) return null;
  const old = params['foliation'];
  const components =
    typeof old === 'object' && old !== null && 'components' in old ? { components: old.components } : {};
  return { ...params, foliation: { mode, ...components } };
}
