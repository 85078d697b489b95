// What the daemon would do, in memory and much faster: jobs compute, cuts burn, machines move. Emits
// the same events. For developing the dashboard and for its tests.

import { torusPackage } from './torus_package.mjs';

const kStages = ['read', 'repair', 'foliation', 'quads', 'strips', 'nest', 'toolpath', 'package'];
const kTickMs = 100;
const kSeconds = { stage: 0.35, sheet: 24 };

export class Refusal extends Error {
  constructor(status, code, detail, errors = []) {
    super(detail);
    Object.assign(this, { status, code, errors });
  }
}

const now = () => new Date().toISOString();

function deviceActions(device) {
  const { state } = device.status;
  if (state === 'disconnected') return [];
  if (state === 'alarm') return ['unlock', 'home', 'stop', 'reset'];
  if (state === 'idle') return ['home', 'jog', 'frame', 'stop', 'reset', 'console'];
  return state === 'hold' ? ['resume', 'stop', 'reset'] : ['hold', 'stop', 'reset'];
}

export class FakeDaemon {
  constructor({ pace = 1 } = {}) {
    this.pace = pace;
    this.jobs = new Map();
    this.cuts = new Map();
    this.meshes = new Map(); // What was sent, by job.
    this.packages = new Map();
    this.devices = new Map();
    this.log = [];
    this.listeners = new Set();
    this.next = 1;
    this.addDevice('sim', 'Simulated laser', 'sim:grbl', 'idle');
    this.addDevice('garage', 'Garage K40', 'grbl:/dev/ttyUSB0?baud=115200', 'disconnected');
    this.timer = setInterval(() => this.tick((kTickMs / 1000) * this.pace), kTickMs);
  }

  stop() {
    clearInterval(this.timer);
  }

  addDevice(id, name, uri, state) {
    const status = {
      state, machine_position_mm: [0, 0, 0], work_position_mm: [0, 0, 0], feed_mm_per_min: 0, power_s: 0,
      override_percent: [100, 100, 100], alarm_code: null, message: '', firmware: state === 'disconnected' ? '' : 'Grbl 1.1h',
    };
    this.devices.set(id, { id, name, uri, auto_start: false, bed_mm: [600, 400], status, cut: null, console: [], actions: [] });
  }

  snapshot() {
    const all = (map) => [...map.values()].map((item) => this.view(item));
    return { seq: this.log.length, jobs: all(this.jobs), cuts: all(this.cuts), devices: all(this.devices) };
  }

  queue() {
    const waiting = [...this.jobs.values()].filter((job) => job.state === 'queued');
    const next = waiting.map(({ id, name }) => ({ id, name, priority: 0 }));
    return { paused: this.paused === true, reason: '', queued: next.length, computing: 0, dead_letters: 0, next };
  }

  // An item as the interface shows it.
  view(item) {
    const { lines, done, work, ...shown } = item;
    return item.status === undefined ? shown : { ...shown, actions: deviceActions(item) };
  }

  emit(type, item) {
    const seq = type === 'device' ? null : this.log.length + 1;
    const event = { seq, type, [type]: structuredClone(this.view(item)) };
    if (seq !== null) {
      item.version = (item.version ?? 0) + 1;
      event[type].version = item.version;
      this.log.push(event);
    }
    for (const listener of this.listeners) listener(event);
  }

  job(id) {
    return this.jobs.get(id) ?? this.missing('job', id);
  }

  missing(kind, id) {
    throw new Refusal(404, 'not-found', `There is no ${kind} ${id}.`);
  }

  addJob({ name, params, file }) {
    const width = params.grid?.strip_width_mm;
    if (width !== undefined && !(width >= 1)) {
      const detail = 'must be at least 1 mm';
      throw new Refusal(422, 'invalid-params', `grid.strip_width_mm: ${detail}`, [{ pointer: '/grid/strip_width_mm', detail }]);
    }
    const id = `j_${String(this.next++).padStart(4, '0')}`;
    const job = {
      id, name: name || file.name, state: 'queued', created_at: now(), updated_at: now(), version: 0, file, params,
      progress: { stage: '', fraction: 0 }, error: null, summary: null, sheets: [], cuts: [], actions: ['cancel'],
    };
    this.jobs.set(id, job);
    this.emit('job', job);
    return job;
  }

  removeJob(id) {
    const job = this.job(id);
    if (job.actions.includes('cancel')) {
      Object.assign(job, { state: 'cancelled', actions: ['remove'] });
      this.emit('job', job);
      return;
    }
    this.jobs.delete(id);
  }

  addCut(jobId, { device, sheets }) {
    const job = this.job(jobId);
    if (!job.actions.includes('cut')) throw new Refusal(409, 'job-not-ready', `${job.name} is ${job.state}; only a ready job can be cut.`);
    const machine = this.devices.get(device) ?? this.missing('device', device);
    const id = `c_${String(this.next++).padStart(4, '0')}`;
    const cut = {
      id, job: jobId, device, sheets: sheets ?? job.sheets.map((sheet) => sheet.id), sheet: 0, state: 'waiting', program_sha256: '',
      progress: {}, reason: '', created_at: now(), updated_at: now(), actions: ['abort'],
    };
    this.cuts.set(id, cut);
    job.cuts.push(id);
    if (machine.cut === null) this.arm(cut, machine);
    else this.emit('cut', cut);
    this.emit('job', job);
    return cut;
  }

  program(cut) {
    return this.packages.get(cut.job).programs.find((program) => program.id === cut.sheet);
  }

  load(cut, sheet) {
    cut.sheet = sheet;
    const program = this.program(cut);
    cut.program_sha256 = program.programSha256;
    const lines = program.gcode.split('\n').filter((line) => line.trim() !== '' && !line.startsWith(';'));
    cut.lines = lines;
    cut.done = 0;
    this.count(cut);
  }

  count(cut) {
    const total = cut.lines.length;
    const acknowledged = Math.min(total, Math.floor(cut.done));
    cut.progress = {
      lines_total: total, lines_sent: Math.min(total, acknowledged + 4), lines_acknowledged: acknowledged, fraction: acknowledged / total,
    };
  }

  arm(cut, machine) {
    machine.cut = cut.id;
    this.load(cut, cut.sheets[0]);
    this.setCut(cut, 'armed', ['start', 'abort']);
  }

  setCut(cut, state, actions, reason = '') {
    Object.assign(cut, { state, actions, reason, updated_at: now() });
    this.emit('cut', cut);
  }

  commandCut(id, action, body) {
    const cut = this.cuts.get(id) ?? this.missing('cut', id);
    if (!cut.actions.includes(action)) throw new Refusal(409, 'wrong-state', `The cut is ${cut.state}; it can't ${action} now.`);
    const machine = this.devices.get(cut.device);
    if (action === 'start' || action === 'confirm-sheet') {
      if (body.program_sha256 !== cut.program_sha256 || body.bed_clear !== true) {
        throw new Refusal(409, 'program-changed', 'That is not the program this cut is armed with.');
      }
    }
    if (action === 'abort') this.endCut(cut, machine, 'aborted', 'Aborted by the operator.');
    else if (action === 'pause') this.moveCut(cut, machine, 'paused', 'hold', ['resume', 'abort']);
    else this.moveCut(cut, machine, 'cutting', 'run', ['pause', 'abort']);
    return cut;
  }

  moveCut(cut, machine, state, deviceState, actions) {
    machine.status.state = deviceState;
    this.setCut(cut, state, actions);
    this.emit('device', machine);
  }

  endCut(cut, machine, state, reason = '') {
    Object.assign(machine.status, { state: 'idle', power_s: 0, feed_mm_per_min: 0 });
    machine.cut = null;
    this.setCut(cut, state, [], reason);
    this.emit('device', machine);
    const waiting = [...this.cuts.values()].find((other) => other.state === 'waiting' && other.device === machine.id);
    if (waiting) this.arm(waiting, machine);
  }

  commandDevice(id, { command, dx_mm: dx = 0, dy_mm: dy = 0 }) {
    const machine = this.devices.get(id) ?? this.missing('device', id);
    if (!deviceActions(machine).includes(command)) {
      throw new Refusal(409, 'wrong-state', `${machine.name} is ${machine.status.state}; it can't ${command} now.`);
    }
    const cut = machine.cut === null ? null : this.cuts.get(machine.cut);
    const { status } = machine;
    if (command === 'stop') {
      Object.assign(status, { state: 'alarm', alarm_code: 3, message: 'Reset while in motion', power_s: 0 });
      if (cut && ['cutting', 'paused'].includes(cut.state)) {
        machine.cut = null;
        this.setCut(cut, 'interrupted', [], `Stopped at line ${Math.floor(cut.done)} of ${cut.lines.length}.`);
      }
    } else if (command === 'jog') {
      status.machine_position_mm = [status.machine_position_mm[0] + dx, status.machine_position_mm[1] + dy, 0];
    } else if (command === 'home') {
      Object.assign(status, { state: 'idle', alarm_code: null, message: '', machine_position_mm: [0, 0, 0] });
    } else if (command === 'unlock') Object.assign(status, { state: 'idle', alarm_code: null, message: '' });
    else if (command === 'hold') return cut ? void this.commandCut(cut.id, 'pause', {}) : undefined;
    else if (command === 'resume') return cut ? void this.commandCut(cut.id, 'resume', {}) : undefined;
    status.work_position_mm = [...status.machine_position_mm];
    this.emit('device', machine);
    return undefined;
  }

  tick(seconds) {
    for (const job of this.jobs.values()) {
      if (job.state === 'computing' || (job.state === 'queued' && !this.paused)) this.compute(job, seconds);
    }
    for (const cut of this.cuts.values()) if (cut.state === 'cutting') this.burn(cut, seconds);
  }

  compute(job, seconds) {
    job.work = (job.work ?? 0) + seconds / kSeconds.stage;
    const stage = Math.floor(job.work);
    job.updated_at = now();
    if (/broken/.test(job.file.name) && stage >= 1) {
      Object.assign(job, { state: 'failed', actions: ['remove'], error: { kind: 'bad-input', code: 'non-manifold', detail: 'face 12: edge 4–9 has three faces; split the mesh there.' } });
    } else if (stage >= kStages.length) this.finish(job);
    else Object.assign(job, { state: 'computing', progress: { stage: kStages[stage], fraction: job.work - stage } });
    this.emit('job', job);
  }

  finish(job) {
    const made = torusPackage({ name: job.name });
    this.packages.set(job.id, made);
    const sheets = made.programs.map(({ id, material, programSha256 }) => ({
      id, material, state: 'uncut', program_sha256: programSha256, estimated_s: 240,
    }));
    Object.assign(job, {
      state: 'ready', sheets, actions: ['remove', 'cut', 'recompute'], progress: { stage: 'package', fraction: 1 },
      summary: { ...made.counts, estimated_s: 240 * sheets.length, warnings: ['12 strips were parted to fit the sheet.'] },
    });
  }

  burn(cut, seconds) {
    const machine = this.devices.get(cut.device);
    cut.done += (cut.lines.length * seconds) / kSeconds.sheet;
    this.count(cut);
    const at = cut.lines.slice(0, Math.floor(cut.done)).reverse().find((line) => /X/.test(line));
    const position = /X(-?[\d.]+) Y(-?[\d.]+)/.exec(at ?? '');
    if (position) machine.status.work_position_mm = [Number(position[1]), Number(position[2]), 0];
    machine.status.machine_position_mm = machine.status.work_position_mm;
    Object.assign(machine.status, { power_s: 800, feed_mm_per_min: 1200 });
    this.emit('device', machine);
    if (cut.done < cut.lines.length) this.emit('cut', cut);
    else this.sheetDone(cut, machine);
  }

  sheetDone(cut, machine) {
    const job = this.jobs.get(cut.job);
    job.sheets = job.sheets.map((sheet) => (sheet.id === cut.sheet ? { ...sheet, state: 'cut' } : sheet));
    const following = cut.sheets[cut.sheets.indexOf(cut.sheet) + 1];
    if (following === undefined) this.endCut(cut, machine, 'done');
    else {
      this.load(cut, following);
      this.moveCut(cut, machine, 'awaiting-sheet', 'idle', ['confirm-sheet', 'abort']);
    }
    if (job.sheets.every((sheet) => sheet.state === 'cut')) Object.assign(job, { state: 'done' });
    this.emit('job', job);
  }
}
