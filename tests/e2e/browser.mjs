// A headless Chromium, and what the tests need to know of a page: pictures, faults, accessibility.

import { createRequire } from 'node:module';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const require = createRequire(path.resolve(here, '../../web/package.json'));
const { chromium } = require('playwright-core');
const axeSource = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

export const pictures = process.env.LEAFCUTTER_SCREENSHOTS ?? path.resolve(here, '../../build/screenshots');

function findChromium() {
  const places = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const found = places.find((place) => place && existsSync(place));
  if (!found) throw new Error('no Chromium: install the package "chromium" or set CHROMIUM');
  return found;
}

export function launch() {
  mkdirSync(pictures, { recursive: true });
  return chromium.launch({
    executablePath: findChromium(),
    args: [
      '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync',
    ],
  });
}

const kPatience = 120_000; // Of every wait: the machine may be busy with other things.
export const kDesktop = { width: 1360, height: 900 };
export const kPhone = { width: 360, height: 780 };

// A page in a profile of its own. `faults` collects what the console and the network complain of.
export async function openPage(browser, url, { viewport = kDesktop, colorScheme = 'light', ...more } = {}) {
  const context = await browser.newContext({ viewport, colorScheme, reducedMotion: 'reduce', ...more });
  context.setDefaultTimeout(kPatience);
  const page = await context.newPage();
  const faults = [];
  page.on('console', (message) => {
    if (message.type() === 'error') faults.push(message.text());
  });
  page.on('pageerror', (fault) => faults.push(String(fault)));
  await page.goto(url);
  return { page, faults, close: () => context.close() };
}

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// Reads until what is read is right, and returns it: a page shows the outcome of a click in its own time.
export async function until(read, isRight, what) {
  let last;
  for (const end = Date.now() + kPatience; Date.now() < end; await pause(100)) {
    last = await read();
    if (isRight(last)) return last;
  }
  throw new Error(`waited in vain for ${what}; last: ${String(last).slice(0, 400)}`);
}

// Reads until it was the same for a second.
export async function steady(read) {
  let [last, since] = [await read(), Date.now()];
  return until(async () => {
    const now = await read();
    if (now !== last) [last, since] = [now, Date.now()];
    return now;
  }, () => Date.now() - since >= 1000, 'something steady');
}

export async function picture(page, name, { fullPage = true } = {}) {
  const file = path.join(pictures, `${name}.png`);
  await page.screenshot({ path: file, fullPage });
  return file;
}

// Drops files on the page as a desktop would.
export async function drop(page, files) {
  const transfer = await page.evaluateHandle((given) => {
    const data = new DataTransfer();
    for (const { name, text } of given) data.items.add(new File([text], name));
    return data;
  }, files);
  for (const type of ['dragenter', 'dragover', 'drop']) await page.dispatchEvent('main', type, { dataTransfer: transfer });
}

// All faults that axe finds, as short lines. The script is run in the page by the
// debugger, so it needs no hole in the page's content policy.
export async function axeFaults(page) {
  await page.evaluate(axeSource);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target.join(' ')).join(', ')}`);
}

// How many different colours the canvas shows: 1 when nothing was drawn.
export function canvasColours(page) {
  return page.locator('.model canvas').evaluate((canvas) => {
    const small = document.createElement('canvas');
    [small.width, small.height] = [64, 64];
    const context = small.getContext('2d');
    context.drawImage(canvas, 0, 0, 64, 64);
    const pixels = new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer);
    return new Set(pixels).size;
  });
}
