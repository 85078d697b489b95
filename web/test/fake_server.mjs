// Serves web/dist and the REST interface of a FakeDaemon, with the headers the real daemon sends.
//   node test/fake_server.mjs [--port 8787] [--pace 1]

import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { FakeDaemon, Refusal } from './fake_daemon.mjs';

const dist = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../dist');
const kTypes = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const kMaterials = [
  { id: 'paper-160-yellow', name: 'Paper 160 g/m², yellow', colour: '#e8c547', thickness_mm: 0.2 },
  { id: 'paper-160-blue', name: 'Paper 160 g/m², blue', colour: '#3f6fb5', thickness_mm: 0.2 },
  { id: 'veneer-oak', name: 'Oak veneer', colour: '#b98a56', thickness_mm: 0.6 },
].map((material) => ({
  ...material, weight_g_per_m2: 160, kerf_mm: 0.15, origin: 'built-in', sheets: [{ width_mm: 600, height_mm: 400 }],
  cut: { power_percent: 60, feed_mm_per_min: 1200, passes: 1 }, score: { power_percent: 20, feed_mm_per_min: 2400, passes: 1 }, engrave: { power_percent: 15, feed_mm_per_min: 3000, passes: 1 },
}));

const kUser = { name: 'ada', role: 'admin', created_at: '2026-01-05T08:00:00Z' };
const kKey = {
  id: 'k1', user: 'ada', label: 'CI', role: 'submitter', may_fire: false, created_at: '2026-01-06T08:00:00Z', expires_at: null, used_at: null,
};
const kOutline = [[0, 0], [420, 0], [420, 180], [300, 180], [300, 260], [0, 260]];
const kStock = [
  { id: 'yellow', kind: 'sheet', material: 'paper-160-yellow', width_mm: 600, height_mm: 400, quantity: 12, planned: 2, from_job: null },
  { id: 'offcut-1', kind: 'remnant', material: 'paper-160-blue', outline: kOutline, holes: [[[40, 40], [120, 40], [120, 90], [40, 90]]], quantity: 1, from_job: null },
];
const kEntries = Array.from({ length: 8 }, (_, k) => ({
  seq: 8 - k, at: `2026-01-07T10:0${8 - k}:00Z`, user: k % 3 === 0 ? null : 'ada', remote: '192.0.2.7', action: `POST /api/v1/cuts/c_${k}/start`, note: '', status: k % 4 === 0 ? 409 : 202,
}));
const kSession = { accounts: false, authenticated: true, user: null, role: null, may_fire: true, csrf_token: null };
const kNodes = ['bench', 'attic'].map((id, k) => ({
  id, role: k === 0 ? 'all' : 'worker', state: 'active', version: '0.1.0', silent_s: 1, machines: k === 0 ? ['sim'] : [], workers: 2, computing: k, cutting: 0,
  actions: ['pause', 'drain'],
}));
const kFleet = { alone: false, node: 'bench', lease_s: 30, nodes: kNodes, machine_leases: [], claims: [] };
const kNodeStates = { pause: 'paused', drain: 'drained', resume: 'active' };

function commandNode(id, command) {
  const node = kNodes.find((one) => one.id === id);
  if (node === undefined) throw new Refusal(404, 'no-such-node', 'there is no node of that name');
  return Object.assign(node, { state: kNodeStates[command], actions: command === 'resume' ? ['pause', 'drain'] : ['resume'] });
}

// Pages that only show what is there; a whole daemon keeps it.
const kShown = {
  '/session': kSession,
  '/version': { name: 'leafcutter', version: '0.1.0', api: 'v1' },
  '/ports': { ports: [{ uri: 'grbl:/dev/ttyUSB0?baud=115200', description: 'USB serial', trouble: '' }] },
  '/stock': { stock: kStock },
  '/presets': { presets: [{ id: 'fine', name: 'Fine', params: { grid: { strip_width_mm: 6 }, weave: { pattern: 'twill-2x2' } } }] },
  '/users': { users: [kUser, { ...kUser, name: 'eve', role: 'operator' }], next_cursor: null },
  '/keys': { keys: [kKey], next_cursor: null },
  '/fleet': kFleet,
  '/audit': { entries: kEntries, next_cursor: null },
};

function sendJson(response, status, value) {
  response.writeHead(status, { 'Content-Type': 'application/json' });
  response.end(JSON.stringify(value));
}

async function bodyOf(request) {
  const chunks = [];
  for await (const chunk of request) chunks.push(chunk);
  return Buffer.concat(chunks);
}

async function jsonOf(request) {
  const body = await bodyOf(request);
  return body.length === 0 ? {} : JSON.parse(body.toString());
}

async function formOf(request) {
  const body = await bodyOf(request);
  return new Response(body, { headers: { 'Content-Type': request.headers['content-type'] } }).formData();
}

function serveFile(request, response) {
  const { pathname } = new URL(request.url, 'http://localhost');
  const file = path.join(dist, pathname === '/' ? 'index.html' : pathname);
  if (!file.startsWith(dist) || !existsSync(file)) throw new Refusal(404, 'not-found', `There is no ${pathname}.`);
  response.writeHead(200, { 'Content-Type': kTypes[path.extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
}

function serveEvents(daemon, request, response) {
  response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' });
  const write = (event) => {
    const id = event.seq === null ? '' : `id: ${event.seq}\n`;
    response.write(`${id}event: ${event.type}\ndata: ${JSON.stringify(event)}\n\n`);
  };
  response.write('retry: 2000\n\n');
  const last = Number(request.headers['last-event-id'] ?? NaN);
  if (last <= daemon.log.length) daemon.log.slice(last).forEach(write);
  else write({ type: 'snapshot', ...daemon.snapshot() });
  daemon.listeners.add(write);
  const heartbeat = setInterval(() => response.write(': heartbeat\n\n'), 15_000);
  response.on('close', () => {
    clearInterval(heartbeat);
    daemon.listeners.delete(write);
  });
}

async function createJob(daemon, request, response) {
  const form = await formOf(request);
  const mesh = form.get('mesh');
  const params = form.get('params');
  const text = typeof params === 'string' ? params : await params.text();
  const job = daemon.addJob({
    name: form.get('name'), params: JSON.parse(text), file: { name: mesh.name, bytes: mesh.size, sha256: '0'.repeat(64) },
  });
  daemon.meshes.set(job.id, await mesh.text());
  response.setHeader('Location', `/api/v1/jobs/${job.id}`);
  sendJson(response, 201, job);
}

async function recomputeJob(daemon, id, request, response) {
  const { name, params, file } = daemon.job(id);
  const job = daemon.addJob({ name, params: (await jsonOf(request)).params ?? params, file });
  daemon.meshes.set(job.id, daemon.meshes.get(id));
  sendJson(response, 201, job);
}

function sendMesh(daemon, id, response) {
  const text = daemon.meshes.get(id) ?? daemon.missing('mesh', id);
  response.writeHead(200, { 'Content-Type': 'application/octet-stream', 'Content-Disposition': 'attachment' });
  response.end(text);
}

function artifactFiles(daemon, id) {
  return daemon.packages.get(id)?.files ?? daemon.missing('package', id);
}

function listArtifacts(daemon, id) {
  const files = [...artifactFiles(daemon, id)];
  return { artifacts: files.map(([name, text]) => ({ path: name, bytes: text.length, sha256: '', media_type: 'text/plain' })) };
}

function sendArtifact(daemon, response, id, name) {
  const text = artifactFiles(daemon, id).get(name) ?? daemon.missing('artifact', name);
  response.writeHead(200, { 'Content-Type': 'text/plain', 'Content-Disposition': 'attachment' });
  response.end(text);
}

// [method, pattern, handler(daemon, words, request, response)]
const kRoutes = [
  ['GET', /^\/jobs$/, (d, _, q, r) => sendJson(r, 200, { jobs: d.snapshot().jobs, next_cursor: null })],
  ['POST', /^\/jobs$/, (d, _, q, r) => createJob(d, q, r)],
  ['GET', /^\/jobs\/([^/]+)$/, (d, [id], q, r) => sendJson(r, 200, d.view(d.job(id)))],
  ['DELETE', /^\/jobs\/([^/]+)$/, (d, [id], q, r) => { d.removeJob(id); r.writeHead(204).end(); }],
  ['GET', /^\/jobs\/([^/]+)\/artifacts$/, (d, [id], q, r) => sendJson(r, 200, listArtifacts(d, id))],
  ['GET', /^\/jobs\/([^/]+)\/artifacts\/(.+)$/, (d, [id, name], q, r) => sendArtifact(d, r, id, name)],
  ['GET', /^\/jobs\/([^/]+)\/mesh$/, (d, [id], q, r) => sendMesh(d, id, r)],
  ['POST', /^\/jobs\/([^/]+)\/recompute$/, (d, [id], q, r) => recomputeJob(d, id, q, r)],
  ['POST', /^\/jobs\/([^/]+)\/cuts$/, async (d, [id], q, r) => sendJson(r, 201, d.view(d.addCut(id, await jsonOf(q))))],
  ['GET', /^\/cuts$/, (d, _, q, r) => sendJson(r, 200, { cuts: d.snapshot().cuts })],
  ['GET', /^\/cuts\/([^/]+)$/, (d, [id], q, r) => sendJson(r, 200, d.view(d.cuts.get(id) ?? d.missing('cut', id)))],
  ['POST', /^\/cuts\/([^/]+)\/([a-z-]+)$/, async (d, [id, action], q, r) => sendJson(r, 200, d.view(d.commandCut(id, action, await jsonOf(q))))],
  ['GET', /^\/devices$/, (d, _, q, r) => sendJson(r, 200, { devices: d.snapshot().devices })],
  ['POST', /^\/devices\/([^/]+)\/commands$/, async (d, [id], q, r) => { d.commandDevice(id, await jsonOf(q)); sendJson(r, 202, {}); }],
  ['GET', /^\/materials$/, (d, _, q, r) => sendJson(r, 200, { materials: kMaterials })],
  ['GET', /^\/queue$/, (d, _, q, r) => sendJson(r, 200, d.queue())],
  ['POST', /^\/queue\/(pause|resume)$/, (d, [word], q, r) => { d.paused = word === 'pause'; sendJson(r, 200, d.queue()); }],
  ['GET', /^\/devices\/[^/]+\/settings$/, (d, _, q, r) => sendJson(r, 200, { settings: [{ key: '$110', value: 8000, name: 'X maximum rate' }] })],
  ['GET', /^\/(session|version|ports|stock|presets|users|keys|audit|fleet)$/, (d, [name], q, r) => sendJson(r, 200, kShown[`/${name}`])],
  ['POST', /^\/fleet\/([^/]+)\/(pause|drain|resume)$/, (d, [id, word], q, r) => sendJson(r, 202, commandNode(id, word))],
  ['GET', /^\/events$/, (d, _, q, r) => serveEvents(d, q, r)],
];

async function handle(daemon, request, response) {
  const { pathname } = new URL(request.url, 'http://localhost');
  if (!pathname.startsWith('/api/v1')) return serveFile(request, response);
  const rest = decodeURIComponent(pathname.slice('/api/v1'.length));
  for (const [method, pattern, handler] of kRoutes) {
    const match = pattern.exec(rest);
    if (match && method === request.method) return handler(daemon, match.slice(1), request, response);
  }
  throw new Refusal(404, 'not-found', `There is no ${request.method} ${pathname}.`);
}

function sendProblem(response, fault) {
  const status = fault instanceof Refusal ? fault.status : 500;
  const problem = {
    type: `https://leafcutter.dev/problems/${fault.code ?? 'internal'}`,
    title: fault.code ?? 'Internal error', status, detail: fault.message, code: fault.code ?? 'internal', errors: fault.errors ?? [],
  };
  response.writeHead(status, { 'Content-Type': 'application/problem+json' });
  response.end(JSON.stringify(problem));
}

// → { url, daemon, dropStreams(), close() }
export async function startFakeServer({ port = 0, pace = 1 } = {}) {
  const daemon = new FakeDaemon({ pace });
  const streams = new Set();
  const server = createServer((request, response) => {
    response.setHeader('Content-Security-Policy', "default-src 'self'; script-src 'self'; style-src 'self'; object-src 'none'; base-uri 'none'; frame-ancestors 'none'");
    response.setHeader('X-Content-Type-Options', 'nosniff');
    if (request.url.endsWith('/events')) {
      streams.add(response);
      response.on('close', () => streams.delete(response));
    }
    handle(daemon, request, response).catch((fault) => sendProblem(response, fault));
  });
  await new Promise((resolve) => server.listen(port, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    daemon,
    dropStreams: () => streams.forEach((stream) => stream.destroy()),
    close() {
      daemon.stop();
      server.closeAllConnections();
      server.close();
    },
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({ options: { port: { type: 'string', default: '8787' }, pace: { type: 'string', default: '1' } } });
  const { url } = await startFakeServer({ port: Number(values.port), pace: Number(values.pace) });
  console.log(`the dashboard with a made-up daemon: ${url}`);
}
