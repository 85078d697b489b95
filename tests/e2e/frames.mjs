// How long a frame of a 20,000-quad weave takes to draw, in this machine's Chromium (without a GPU: in
// software). Prints the median and the slowest twentieth; fails if turning the model would stutter badly.
//   node frames.mjs [most milliseconds]

import { torusPackage } from '../../web/test/torus_package.mjs';
import { startFakeServer } from '../../web/test/fake_server.mjs';
import { launch, openPage } from './browser.mjs';

const kQuads = { columns: 200, rows: 100 };
const most = Number(process.argv[2] ?? 250);

const server = await startFakeServer();
const made = torusPackage(kQuads);
const job = server.daemon.addJob({ name: 'large', params: {}, file: { name: 'large.off', bytes: 1, sha256: '0'.repeat(64) } });
server.daemon.finish(job);
server.daemon.packages.set(job.id, made);
const browser = await launch();
try {
  const { page } = await openPage(browser, `${server.url}/#/jobs/${job.id}`);
  await page.waitForSelector('.model canvas[data-ready=true]', { timeout: 120_000 });
  await page.focus('.model canvas');
  const times = await page.evaluate(async () => {
    const canvas = document.querySelector('.model canvas');
    const gl = canvas.getContext('webgl2');
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    const pixel = new Uint8Array(4);
    const all = [];
    for (let k = 0; k < 40; k += 1) {
      canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }));
      const start = performance.now();
      await frame();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // Waits until all is drawn.
      all.push(performance.now() - start);
    }
    return all.slice(5).sort((a, b) => a - b);
  });
  const at = (share) => times[Math.floor(share * (times.length - 1))];
  const renderer = await page.evaluate(() => {
    const gl = document.querySelector('.model canvas').getContext('webgl2');
    const info = gl.getExtension('WEBGL_debug_renderer_info');
    return info === null ? 'unknown' : gl.getParameter(info.UNMASKED_RENDERER_WEBGL);
  });
  console.log(`${kQuads.columns * kQuads.rows} quads: ${at(0.5).toFixed(0)} ms a frame, slowest twentieth ${at(0.95).toFixed(0)} ms (${renderer})`);
  if (at(0.5) > most) process.exitCode = 1;
} finally {
  await browser.close();
  server.close();
}
