// A job made for one machine: the language of its programs, and whether its bed is large enough.

import type { Device, Material } from '../api/types.ts';

export type Dialect = 'grbl' | 'marlin' | 'smoothie';

// By what the firmware says of itself, else by the address.
export function dialectOf(device: Pick<Device, 'uri'> & { readonly status: Pick<Device['status'], 'firmware'> }): Dialect {
  const said = device.status.firmware === '' ? device.uri : device.status.firmware;
  if (/marlin/i.test(said)) return 'marlin';
  return /smoothie/i.test(said) ? 'smoothie' : 'grbl';
}

const kStandardSheet = { widthMm: 600, heightMm: 400 };

// The sheet that new ones are taken of.
export function newSheet(material: Material | undefined): { readonly widthMm: number; readonly heightMm: number } {
  return material?.sheets[0] ?? kStandardSheet;
}

// Whether a sheet of `material` lies on the bed, as its programs have it. A bed of unknown size takes all.
export function fitsBed(device: Pick<Device, 'bedMm'>, material: Material | undefined): boolean {
  const { widthMm, heightMm } = newSheet(material);
  const [wide = 0, high = 0] = device.bedMm;
  if (wide <= 0 || high <= 0) return true;
  return widthMm <= wide && heightMm <= high;
}
