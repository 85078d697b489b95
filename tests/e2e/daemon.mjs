// What the tests run against: a daemon that runs already, one started here, or the made-up one.

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';

import { startFakeServer } from '../../web/test/fake_server.mjs';

const kStartMs = 20_000;

// Resolves with the first address that the daemon prints.
function addressOf(child) {
  return new Promise((resolve, reject) => {
    let said = '';
    const timer = setTimeout(() => reject(new Error(`the daemon named no address:\n${said}`)), kStartMs);
    const listen = (chunk) => {
      said += chunk;
      const address = /https?:\/\/[\w.[\]:-]+:\d+/.exec(said);
      if (address === null) return;
      clearTimeout(timer);
      resolve(address[0]);
    };
    child.stdout.on('data', listen);
    child.stderr.on('data', listen);
    child.on('exit', (code) => reject(new Error(`the daemon ended with ${code}:\n${said}`)));
  });
}

async function startDaemon(binary) {
  const state = mkdtempSync(path.join(tmpdir(), 'leafcutter-e2e-'));
  const child = spawn(binary, ['serve', '--state', state, '--listen', '127.0.0.1:0'], { stdio: ['ignore', 'pipe', 'pipe'] });
  const ended = new Promise((resolve) => child.on('exit', resolve));
  const close = async () => {
    child.kill('SIGTERM');
    await ended;
    rmSync(state, { recursive: true, force: true });
  };
  try {
    return { url: await addressOf(child), made: 'daemon', close };
  } catch (fault) {
    await close();
    throw fault;
  }
}

// `made`: "given", "daemon" or "fake". Only a fake can lose its streams on demand.
export async function startTarget() {
  const given = process.argv[2];
  if (given) return { url: given.replace(/\/$/, ''), made: 'given', close: async () => undefined };
  const binary = process.env.LEAFCUTTER_BIN;
  if (binary) return startDaemon(path.resolve(binary));
  const server = await startFakeServer({ pace: 2 });
  return { url: server.url, made: 'fake', dropStreams: server.dropStreams, close: async () => server.close() };
}
