// What the tests run against: a daemon that runs already, one started here, or the made-up one.

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

import { startFakeServer } from '../../web/test/fake_server.mjs';

const kStartMs = 20_000;
const kSpeed = 40; // Simulated seconds per second.

function freePort() {
  return new Promise((resolve, reject) => {
    const probe = createServer();
    probe.on('error', reject);
    probe.listen(0, '127.0.0.1', () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

async function untilHealthy(url, child, said) {
  for (const end = Date.now() + kStartMs; Date.now() < end; await sleep(50)) {
    if (child.exitCode !== null) break;
    const healthy = await fetch(`${url}/healthz`).then((answer) => answer.ok, () => false);
    if (healthy) return;
  }
  throw new Error(`the daemon does not answer:\n${said()}`);
}

// A simulated machine in a hurry beside the daemon's own, which keeps real time.
async function addFastMachine(url, name) {
  const body = JSON.stringify({ name, uri: `sim:grbl?speed=${kSpeed}`, auto_start: false, bed_mm: [600, 400] });
  const answer = await fetch(`${url}/api/v1/devices/fast`, {
    method: 'PUT', headers: { 'Content-Type': 'application/json' }, body,
  });
  if (!answer.ok) throw new Error(`no fast machine: ${answer.status} ${await answer.text()}`);
}

async function startDaemon(binary) {
  const state = mkdtempSync(path.join(tmpdir(), 'leafcutter-e2e-'));
  const port = await freePort();
  const url = `http://127.0.0.1:${port}`;
  let said = '';
  let child;
  let ended;
  const start = async () => {
    child = spawn(binary, ['serve', '--state', state, '--listen', `127.0.0.1:${port}`], { stdio: ['ignore', 'pipe', 'pipe'] });
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (chunk) => (said += chunk));
    const mine = child;
    ended = new Promise((resolve) => mine.on('exit', resolve));
    await untilHealthy(url, mine, () => said);
  };
  const end = async (signal) => {
    child.kill(signal);
    await ended;
  };
  // As a power cut would: without a word.
  const restart = async () => {
    await end('SIGKILL');
    await start();
  };
  const close = async () => {
    await end('SIGTERM');
    rmSync(state, { recursive: true, force: true });
  };
  const device = 'Fast simulated laser';
  try {
    await start();
    await addFastMachine(url, device);
    return { url, made: 'daemon', device, restart, close };
  } catch (fault) {
    await close();
    throw fault;
  }
}

// `made`: "given", "daemon" or "fake"; only a fake can lose its streams on demand. `device` is the name of
// the machine to cut on, if it matters.
export async function startTarget() {
  const given = process.argv[2];
  if (given) return { url: given.replace(/\/$/, ''), made: 'given', close: async () => undefined };
  const binary = process.env.LEAFCUTTER_BIN;
  if (binary) return startDaemon(path.resolve(binary));
  const server = await startFakeServer({ pace: 2 });
  return { url: server.url, made: 'fake', dropStreams: server.dropStreams, close: async () => server.close() };
}
