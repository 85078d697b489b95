// Numbers, sizes and times as people read them. Pure: the current time is always an argument.

let locale = 'en';

// Everything below speaks this language from now on.
export function formatIn(tag: string): void {
  locale = tag;
}

export function count(value: number): string {
  return new Intl.NumberFormat(locale, { maximumFractionDigits: 0 }).format(value);
}

// `digits` significant digits, without an exponent for the sizes that occur here.
export function figure(value: number, digits = 3): string {
  return new Intl.NumberFormat(locale, { maximumSignificantDigits: digits }).format(value);
}

export function bytes(value: number): string {
  const units = ['B', 'kB', 'MB', 'GB'];
  let scaled = value;
  let unit = 0;
  while (scaled >= 1000 && unit < units.length - 1) {
    scaled /= 1000;
    unit += 1;
  }
  return `${figure(scaled, unit === 0 ? 4 : 3)} ${units[unit] ?? ''}`;
}

// "42 s", "14 min", "1 h 05 min".
export function duration(seconds: number): string {
  if (seconds < 59.5) return `${Math.max(0, Math.round(seconds))} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, '0')} min`;
}

// "3:07", "1:02:09": the place in a recording.
export function clock(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const two = (value: number): string => String(value).padStart(2, '0');
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

export function dateTime(rfc3339: string, timeStyle: 'short' | 'medium' = 'short'): string {
  const then = new Date(rfc3339);
  if (Number.isNaN(then.getTime())) return '';
  return new Intl.DateTimeFormat(locale, { dateStyle: 'medium', timeStyle }).format(then);
}

// Under 10 kg in grams.
export function weight(grams: number): string {
  return grams < 10_000 ? `${figure(grams, 3)} g` : `${figure(grams / 1000, 3)} kg`;
}

export function percent(fraction: number): string {
  return `${Math.floor(Math.min(1, Math.max(0, fraction)) * 100)} %`;
}

export function millimetres(value: number): string {
  return value.toFixed(2);
}

// The first characters of a hash: enough to compare by eye.
export function shortHash(sha256: string): string {
  return sha256.slice(0, 12);
}

export function age(rfc3339: string, now: Date): string {
  const then = new Date(rfc3339);
  const seconds = (now.getTime() - then.getTime()) / 1000;
  if (Number.isNaN(seconds)) return '';
  const ago = new Intl.RelativeTimeFormat(locale, { numeric: 'auto' });
  if (seconds < 45) return ago.format(0, 'second');
  if (seconds < 3600) return ago.format(-Math.max(1, Math.round(seconds / 60)), 'minute');
  if (seconds < 86400) return ago.format(-Math.round(seconds / 3600), 'hour');
  return new Intl.DateTimeFormat(locale, { dateStyle: 'medium' }).format(then);
}

// "rocker-arm.v2.obj" -> "rocker-arm.v2"
export function stem(fileName: string): string {
  return fileName.replace(/\.[^.]+$/, '') || fileName;
}
