// A machine by hand, and what the page does while nobody looks, at the real daemon: jogging by keyboard with a
// dead-man, overrides, console, controller settings; an upload on a slow line; notifications; views at rest.
//   LEAFCUTTER_BIN=… node machines.mjs

import assert from 'node:assert/strict';
import { after, before } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';

import { axeFaults, drop, launch, openPage, picture, steady, until } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { torusOff } from './mesh.mjs';
import { step } from './story.mjs';
import { layWire } from './wire.mjs';

let target;
let wire;
let browser;
let desk;

before(async () => {
  target = await startTarget();
  assert.equal(target.made, 'daemon', 'set LEAFCUTTER_BIN');
  wire = await layWire(target.url);
  browser = await launch();
  desk = await openPage(browser, `${wire.url}/#/machines`);
});

after(async () => {
  await browser?.close();
  wire?.close();
  await target?.close();
});

const card = () => desk.page.locator('.machine', { has: desk.page.getByRole('heading', { name: target.device, exact: true }) });
const device = async () => (await fetch(`${target.url}/api/v1/devices/fast`)).json();
const headX = async () => (await device()).status.work_position_mm[0];
const pad = () => card().getByRole('button', { name: 'Right', exact: true });

step('a held arrow key moves the head until it is let go', async () => {
  const { page } = desk;
  await card().waitFor();
  await card().getByRole('button', { name: '1', exact: true }).click();
  await pad().focus();
  const from = await steady(headX);
  await page.keyboard.down('ArrowRight');
  await until(headX, (now) => now > from + 4, 'more than one step of 1 mm');
  await page.keyboard.up('ArrowRight');
  const rest = await steady(headX);
  await sleep(1500);
  assert.equal(await headX(), rest, 'it went on after the key was let go');
});

step('a window that loses its focus lets go of the key', async () => {
  const { page } = desk;
  const from = await steady(headX);
  await page.keyboard.down('ArrowRight');
  await until(headX, (now) => now > from + 3, 'a moving head');
  await page.evaluate(() => dispatchEvent(new Event('blur')));
  const rest = await steady(headX);
  await sleep(1500);
  assert.equal(await headX(), rest);
  await page.keyboard.up('ArrowRight');
});

step('a line that breaks ends the jog, and mending it does not begin it again', async () => {
  const { page } = desk;
  const from = await steady(headX);
  await page.keyboard.down('ArrowRight');
  await until(headX, (now) => now > from + 3, 'a moving head');
  wire.cut();
  const rest = await steady(headX);
  wire.mend();
  await page.waitForSelector('.connection-live');
  await sleep(1500);
  assert.equal(await headX(), rest);
  await page.keyboard.up('ArrowRight');
});

step('feed and power are overridden, and go back to what is programmed', async () => {
  const { page } = desk;
  const now = async () => (await device()).status.override_percent;
  await card().getByRole('button', { name: /more/i }).or(card().locator('.override').first().getByRole('button').last()).first().click();
  await until(now, ([feed]) => feed === 110, 'a feed of 110 %');
  const shown = card().locator('.override-now').first();
  await until(() => shown.innerText(), (text) => /110/.test(text), '110 % on the page');
  await shown.click();
  await until(now, ([feed]) => feed === 100, 'the feed as programmed');
  assert.deepEqual(await axeFaults(page), []);
});

step('the console says what the controller answers', async () => {
  await card().locator('.console summary').first().click();
  const line = card().locator('.console-line input');
  await line.fill('$I');
  await line.press('Enter');
  await until(() => card().locator('.console pre').first().innerText(), (text) => /VER:/.test(text), 'its version');
});

step('a value of the controller is changed', async () => {
  await card().getByText('Controller settings').click();
  const row = card().locator('tr', { has: desk.page.getByRole('textbox', { name: /^\$110 / }) });
  const rate = row.getByRole('textbox');
  await rate.waitFor();
  await rate.fill('4321');
  await row.getByRole('button').click();
  const value = async () => {
    const { settings } = await (await fetch(`${target.url}/api/v1/devices/fast/settings`)).json();
    return settings.find((one) => one.key === '$110').value;
  };
  await until(value, (now) => now === 4321, 'the new rate');
  assert.deepEqual(await axeFaults(desk.page), []);
  await picture(desk.page, 'machine-open-light');
});

step('an upload on a slow line tells how far it is, and can be given up', async () => {
  const { page, close } = await openPage(browser, target.url);
  await page.waitForSelector('.connection-live');
  const line = await page.context().newCDPSession(page);
  await line.send('Network.enable');
  await drop(page, [{ name: 'slow.off', text: torusOff({ columns: 200, rows: 100 }) }, { name: 'other.off', text: torusOff() }]);
  await until(() => page.locator('.mesh-good').count(), (now) => now === 2, 'two meshes');
  await line.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: 1e6, uploadThroughput: 60_000 });
  await page.click('.new-job [type=submit]');
  const bar = page.locator('.job-row.sending', { hasText: 'slow' }).getByRole('progressbar');
  await until(async () => Number(await bar.getAttribute('aria-valuenow')), (now) => now > 0 && now < 100, 'a part that is sent');
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'sending-light');
  await page.locator('.job-row.sending', { hasText: 'slow' }).getByRole('button').click();
  await page.locator('.job-row.sending', { hasText: 'slow' }).waitFor({ state: 'detached' });
  await page.locator('.job-row:not(.sending)', { hasText: 'other' }).waitFor();
  const { jobs } = await (await fetch(`${target.url}/api/v1/jobs`)).json();
  assert.deepEqual(jobs.map((job) => job.name), ['other']);
  await close();
});

// In a page, before it begins: what would pop up on the desktop.
function catchNotifications() {
  globalThis.popped = [];
  globalThis.Notification = class {
    static permission = 'default';
    static requestPermission() {
      this.permission = 'granted';
      return Promise.resolve('granted');
    }
    constructor(title, { body }) {
      globalThis.popped.push(body);
    }
  };
}

step('a page out of sight notifies of what is ready, one in sight does not', async () => {
  const { page, close } = await openPage(browser, 'about:blank');
  await page.addInitScript(catchNotifications);
  await page.goto(`${target.url}/#/settings`);
  await page.getByLabel(/^Notify me/).check();
  const weave = async (name) => {
    const form = new FormData();
    form.append('name', name);
    form.append('params', JSON.stringify({ grid: { strip_width_mm: 16 }, nesting: { time_s: 0.5 } }));
    form.append('mesh', new Blob([torusOff()]), `${name}.off`);
    const { id } = await (await fetch(`${target.url}/api/v1/jobs`, { method: 'POST', body: form })).json();
    await until(async () => (await (await fetch(`${target.url}/api/v1/jobs/${id}`)).json()).state, (now) => now === 'ready', name);
  };
  await weave('seen');
  await page.evaluate(() => Object.defineProperty(document, 'visibilityState', { value: 'hidden', configurable: true }));
  await weave('unseen');
  const popped = () => page.evaluate(() => globalThis.popped);
  await until(popped, (all) => all.length > 0, 'a notification');
  assert.equal((await popped()).length, 1);
  assert.match((await popped())[0], /unseen/);
  await close();
});

step('a model at rest is not drawn, one that is turned is', async () => {
  const { page, close } = await openPage(browser, target.url);
  await page.locator('.job-row', { hasText: 'unseen' }).getByRole('link').click();
  await page.waitForSelector('.model canvas[data-ready=true]');
  await page.evaluate(() => {
    globalThis.drawn = 0;
    for (const name of ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced']) {
      const draw = WebGL2RenderingContext.prototype[name];
      WebGL2RenderingContext.prototype[name] = function counted(...args) {
        globalThis.drawn += 1;
        return draw.apply(this, args);
      };
    }
  });
  const drawn = () => page.evaluate(() => globalThis.drawn);
  const rest = await steady(drawn);
  await sleep(3000);
  assert.equal(await drawn(), rest, 'drawn while nothing moved');
  await page.focus('.model canvas');
  await page.keyboard.press('ArrowLeft');
  await until(drawn, (now) => now > rest, 'a frame');
  await close();
});
