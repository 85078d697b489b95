// Faults in the middle of a cut, seen from two browsers at the real daemon: it is killed and comes back, its
// network is cut and mended.
//   LEAFCUTTER_BIN=… node faults.mjs

import assert from 'node:assert/strict';
import { after, before } from 'node:test';

import { axeFaults, drop, kPhone, launch, openPage, picture, until } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { torusOff } from './mesh.mjs';
import { step } from './story.mjs';
import { layWire } from './wire.mjs';

const kMachine = 'Simulated laser'; // Keeps real time: a sheet takes it many minutes.

let target;
let wire; // The desk comes through it.
let browser;
let desk;
let phone; // Beside the machine, by a way of its own.
let killed = ''; // Id of the cut that was killed.

before(async () => {
  target = await startTarget();
  assert.equal(target.made, 'daemon', 'set LEAFCUTTER_BIN');
  wire = await layWire(target.url);
  browser = await launch();
  desk = await openPage(browser, wire.url);
});

after(async () => {
  await browser?.close();
  wire?.close();
  await target?.close();
});

const both = () => [desk.page, phone.page];
const cuts = async () => (await (await fetch(`${target.url}/api/v1/cuts`)).json()).cuts;
const cutNow = async (id) => (await fetch(`${target.url}/api/v1/cuts/${id}`)).json();
const burntLength = (page) =>
  page.evaluate(() => [...document.querySelectorAll('.burn path')].reduce((sum, path) => sum + path.getTotalLength(), 0));

async function light(page) {
  await page.waitForSelector('.clear-bed:not(.finish)');
  await page.locator('.clear-bed .tick input').check();
  await page.locator('.button.fire').click();
  await page.waitForSelector('.cut.state-cutting');
}

step('a cut is under way in both browsers', async () => {
  const { page } = desk;
  await drop(page, [{ name: 'ring.off', text: torusOff() }]);
  await page.waitForSelector('.mesh-good');
  await page.getByLabel('Strip width').fill('16');
  await page.getByText('Nesting', { exact: true }).click();
  await page.getByLabel('Search time').fill('1');
  await page.click('.new-job [type=submit]');
  await page.waitForSelector('.model canvas[data-ready=true]');
  phone = await openPage(browser, `${target.url}/${page.url().slice(page.url().indexOf('#'))}`, { viewport: kPhone, hasTouch: true, isMobile: true });
  await page.selectOption('.cut-queue select', { label: kMachine });
  await page.getByRole('button', { name: 'Queue the cut' }).click();
  await light(page);
  for (const one of both()) {
    await one.waitForSelector('.cut.state-cutting');
    await until(() => burntLength(one), (now) => now > 0, 'a burnt part');
  }
  await page.evaluate(() => (globalThis.sameDocument = true));
});

step('the daemon is killed: both browsers say that the cut was interrupted, and nothing burns', async () => {
  killed = (await cuts()).find((one) => one.state === 'cutting').id;
  await target.restart();
  for (const page of both()) {
    await page.waitForSelector('.connection-live');
    await page.locator('.cut-word.cut-interrupted').waitFor();
    await page.locator('.finish').waitFor();
    assert.equal(await page.locator('.cut.state-cutting').count(), 0);
  }
  const cut = await cutNow(killed);
  assert.equal(cut.state, 'interrupted');
  assert.deepEqual((await cuts()).filter((one) => one.state === 'cutting'), []);
  assert.equal(await desk.page.evaluate(() => globalThis.sameDocument), true, 'nobody loaded the page anew');
  for (const page of both()) assert.deepEqual(await axeFaults(page), []);
  await picture(desk.page, 'interrupted-light');
  await picture(phone.page, 'interrupted-phone');
});

step('the operator says what lies there, and the rest waits for its own start', async () => {
  const { page } = desk;
  const form = page.locator('.finish');
  const act = form.getByRole('button');
  assert.equal(await act.isEnabled(), false);
  for (const tick of await form.locator('.tick input').all()) await tick.check();
  const seen = form.getByRole('textbox');
  const { beam } = await cutNow(killed);
  assert.equal(await seen.count(), beam.certain ? 0 : 1);
  if (!beam.certain) {
    assert.equal(await act.isEnabled(), false, 'nobody said how far it got');
    await seen.fill(((beam.least_mm + beam.most_mm) / 2).toFixed(1));
  }
  const answer = page.waitForResponse((one) => one.url().endsWith('/finish'));
  await act.click();
  assert.equal((await answer).status(), 201, await (await answer).text());
  for (const one of both()) await one.waitForSelector('.clear-bed:not(.finish)');
  const rest = (await cuts()).find((one) => one.rest_of === killed);
  assert.ok(['waiting', 'armed'].includes(rest.state), rest.state);
  await picture(page, 'rest-light');
  await light(page);
  await phone.page.waitForSelector('.cut.state-cutting');
});

step('the network is cut while the laser burns: what happened meanwhile is there when it is back', async () => {
  const cut = (await cuts()).find((one) => one.state === 'cutting').id;
  wire.cut();
  await desk.page.waitForSelector('.connection-waiting');
  await phone.page.getByRole('button', { name: 'Pause' }).tap();
  await phone.page.waitForSelector('.cut.state-paused');
  assert.equal(await desk.page.locator('.cut.state-cutting').count(), 1, 'the desk cannot know');
  wire.mend();
  await desk.page.waitForSelector('.connection-live');
  await desk.page.waitForSelector('.cut.state-paused');
  await desk.page.getByRole('button', { name: 'Resume' }).click();
  for (const page of both()) await page.waitForSelector('.cut.state-cutting');
  assert.equal((await cutNow(cut)).state, 'cutting');
});

step('STOP on the phone ends it for both', async () => {
  await phone.page.locator('.stop').tap();
  for (const page of both()) {
    await page.waitForSelector('.cut.state-cutting', { state: 'detached' });
    await page.locator('.cut-word').first().waitFor();
  }
  assert.deepEqual((await cuts()).filter((one) => one.state === 'cutting'), []);
  assert.deepEqual(phone.faults.filter((fault) => !/ERR_|Failed to load resource/.test(fault)), []);
});
