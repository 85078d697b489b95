// Reads a cut program the way the machine will: absolute or relative, G0 to G3, laser on while the
// spindle word is on and S > 0. What it makes is for drawing only; nothing is ever sent from here.

export interface Move {
  readonly line: number; // 1-based, of the file.
  readonly sent: number; // 1-based, among lines that hold a command (comments and blanks are not sent).
  readonly burns: boolean;
  readonly startS: number; // When it starts and ends, if the machine kept every feed at once.
  readonly endS: number;
  readonly points: readonly (readonly [number, number])[]; // From where the move starts; mm.
}

export interface CutProgram {
  readonly lines: number; // All lines of the file.
  readonly sentLines: number; // Lines that hold a command.
  readonly moves: readonly Move[];
  readonly totalS: number;
  readonly burnMm: number;
  readonly travelMm: number;
}

interface Modal {
  x: number;
  y: number;
  motion: number;
  absolute: boolean;
  unit: number;
  laser: boolean;
  power: number;
  feed: number; // mm/min
}

interface Words {
  readonly x: number | undefined;
  readonly y: number | undefined;
  readonly i: number;
  readonly j: number;
}

const kRapidMmPerMin = 6000; // G0 has no feed of its own.
const kArcStep = Math.PI / 24;

function strip(line: string): string {
  return line.replace(/\([^)]*\)/g, '').replace(/;.*$/, '').replace(/\s+/g, '').toUpperCase();
}

function applyCode(modal: Modal, letter: string, value: number): void {
  if (letter === 'S') modal.power = value;
  if (letter === 'F') modal.feed = value * modal.unit;
  if (letter === 'M' && (value === 3 || value === 4)) modal.laser = true;
  if (letter === 'M' && value === 5) modal.laser = false;
  if (letter !== 'G') return;
  if (value >= 0 && value <= 3) modal.motion = value;
  else if (value === 20) modal.unit = 25.4;
  else if (value === 21) modal.unit = 1;
  else if (value === 90) modal.absolute = true;
  else if (value === 91) modal.absolute = false;
}

function readWords(modal: Modal, command: string): Words {
  const found = new Map<string, number>();
  for (const match of command.matchAll(/([A-Z])([-+]?\d*\.?\d+)/g)) {
    const letter = match[1] ?? '';
    const value = Number(match[2]);
    applyCode(modal, letter, value);
    if ('XYIJ'.includes(letter)) found.set(letter, value);
  }
  return { x: found.get('X'), y: found.get('Y'), i: found.get('I') ?? 0, j: found.get('J') ?? 0 };
}

function arcPoints(modal: Modal, words: Words, end: readonly [number, number]): [number, number][] {
  const centre = [modal.x + words.i * modal.unit, modal.y + words.j * modal.unit] as const;
  const radius = Math.hypot(modal.x - centre[0], modal.y - centre[1]);
  const from = Math.atan2(modal.y - centre[1], modal.x - centre[0]);
  let sweep = Math.atan2(end[1] - centre[1], end[0] - centre[0]) - from;
  if (modal.motion === 2 && sweep >= -1e-9) sweep -= 2 * Math.PI;
  if (modal.motion === 3 && sweep <= 1e-9) sweep += 2 * Math.PI;
  const steps = Math.max(1, Math.ceil(Math.abs(sweep) / kArcStep));
  const points: [number, number][] = [];
  for (let step = 1; step < steps; step += 1) {
    const angle = from + (sweep * step) / steps;
    points.push([centre[0] + radius * Math.cos(angle), centre[1] + radius * Math.sin(angle)]);
  }
  return points;
}

function target(modal: Modal, words: Words): [number, number] {
  const go = (now: number, word: number | undefined): number => {
    if (word === undefined) return now;
    return modal.absolute ? word * modal.unit : now + word * modal.unit;
  };
  return [go(modal.x, words.x), go(modal.y, words.y)];
}

function lengthOf(points: readonly (readonly [number, number])[]): number {
  return points.reduce((sum, [x, y], index) => {
    const before = points[index - 1];
    return before === undefined ? sum : sum + Math.hypot(x - before[0], y - before[1]);
  }, 0);
}

export function parseProgram(source: string): CutProgram {
  const modal: Modal = { x: 0, y: 0, motion: 0, absolute: true, unit: 1, laser: false, power: 0, feed: kRapidMmPerMin };
  const lines = source.replace(/\r?\n$/, '').split(/\r?\n/);
  const moves: Move[] = [];
  let [sent, timeS, burnMm, travelMm] = [0, 0, 0, 0];
  lines.forEach((raw, index) => {
    const command = strip(raw);
    if (command === '' || command === '%') return;
    sent += 1;
    const words = readWords(modal, command);
    if (words.x === undefined && words.y === undefined) return;
    const end = target(modal, words);
    const points: [number, number][] = [[modal.x, modal.y]];
    if (modal.motion >= 2) points.push(...arcPoints(modal, words, end));
    points.push(end);
    const burns = modal.motion > 0 && modal.laser && modal.power > 0;
    const mm = lengthOf(points);
    const startS = timeS;
    timeS += (60 * mm) / (modal.motion === 0 ? kRapidMmPerMin : Math.max(1, modal.feed));
    if (burns) burnMm += mm;
    else travelMm += mm;
    moves.push({ line: index + 1, sent, burns, startS, endS: timeS, points });
    [modal.x, modal.y] = end;
  });
  return { lines: lines.length, sentLines: sent, moves, totalS: timeS, burnMm, travelMm };
}
