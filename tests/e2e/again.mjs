// A shape of genus 2 against the real daemon: woven, then woven again with the weights of its cylinders picked
// on the model.
//   LEAFCUTTER_BIN=… node again.mjs

import assert from 'node:assert/strict';
import { after, before } from 'node:test';

import { axeFaults, drop, launch, openPage, picture, until } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { twoHolesOff } from './mesh.mjs';
import { step } from './story.mjs';

let target;
let browser;
let desk;

before(async () => {
  target = await startTarget();
  assert.equal(target.made, 'daemon', 'set LEAFCUTTER_BIN');
  browser = await launch();
  desk = await openPage(browser, target.url);
});

after(async () => {
  await browser?.close();
  await target?.close();
});

const jobNow = async () => (await fetch(`${target.url}/api/v1/jobs/${desk.page.url().split('/').pop()}`)).json();
const reportNow = async () => (await fetch(`${target.url}/api/v1/jobs/${(await jobNow()).id}/artifacts/report.json`)).json();

async function ready() {
  await desk.page.waitForSelector('.model canvas[data-ready=true], .failure');
  if (await desk.page.isVisible('.failure')) assert.fail(await desk.page.innerText('.failure'));
}

step('a machine and the sheets are chosen with the rest', async () => {
  const { page } = desk;
  await page.waitForSelector('.connection-live');
  await drop(page, [{ name: 'holes.off', text: twoHolesOff() }]);
  await page.waitForSelector('.mesh-good');
  assert.match(await page.innerText('.mesh-facts'), /genus 2/);
  const machine = page.getByRole('combobox', { name: 'Machine', exact: true });
  await machine.selectOption({ label: target.device });
  assert.match(await page.getByRole('combobox', { name: 'Sheets', exact: true }).innerText(), /New, \d+/);
  await page.getByLabel('Strip width').fill('16');
  await page.getByText('Nesting', { exact: true }).click();
  await page.getByLabel('Search time').fill('1');
  await page.click('.new-job [type=submit]');
  await ready();
  const job = await jobNow();
  assert.equal(job.params.output.device, 'fast');
  assert.equal(await page.locator('.cut-queue select').inputValue(), 'fast');
});

step('the paper’s table has a row for every cylinder', async () => {
  const { page } = desk;
  const { foliation, quality } = await reportNow();
  const rows = page.locator('.paper-table tbody tr');
  await until(() => rows.count(), (now) => now === foliation.cylinders.length + 1, 'a row of each, and one of all');
  const [first] = foliation.cylinders;
  const cells = (await rows.first().innerText()).split(/\s*\t\s*/);
  assert.match(cells.join(' '), new RegExp(`\\(${first.rows}, ${first.cols}\\)`));
  assert.ok(Math.abs(Number.parseFloat(cells[2]) - quality.cylinders[0].angle_deviation_deg.max) < 0.06, cells.join(' | '));
  assert.deepEqual(await axeFaults(page), []);
});

step('woven again, the mesh of before is there to be picked on', async () => {
  const { page } = desk;
  await page.getByRole('button', { name: 'Change and weave again' }).click();
  await page.waitForSelector('.mesh-view canvas[data-ready=true]');
  assert.match(await page.innerText('.mesh-facts'), /genus 2/);
  await page.locator('.estimate').waitFor();
});

step('a cylinder is picked on the model and made higher by keyboard', async () => {
  const { page } = desk;
  const tool = page.locator('.pick-tool', { has: page.getByLabel('Weights', { exact: true }) });
  await tool.getByRole('button').click();
  const canvas = page.locator('.mesh-view canvas');
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const chosen = page.locator('.weight.chosen');
  for (const [fx, fy] of [[0.2, 0.5], [0.3, 0.6], [0.15, 0.6], [0.3, 0.4]]) {
    await page.mouse.click(box.x + fx * box.width, box.y + fy * box.height);
    if ((await chosen.count()) > 0) break;
  }
  await chosen.waitFor();
  assert.ok(await chosen.getByRole('slider').evaluate((slider) => slider === document.activeElement), 'keys go to what was picked');
  for (let press = 0; press < 12; press += 1) await page.keyboard.press('ArrowRight');
  await until(() => chosen.innerText(), (text) => /1\.5\d? ×/.test(text), 'a cylinder one and a half times as high');
  await picture(page, 'weights-light');
  assert.deepEqual(await axeFaults(page), []);
  await page.emulateMedia({ colorScheme: 'dark' });
  await picture(page, 'weights-dark');
  assert.deepEqual(await axeFaults(page), []);
});

step('the weave has the weights that were picked', async () => {
  const { page } = desk;
  const typed = (await page.getByRole('textbox', { name: 'Weights' }).inputValue()).split(', ').map(Number);
  const before = page.url();
  await page.click('.new-job [type=submit]');
  await until(() => page.url(), (now) => now !== before, 'the new job');
  await ready();
  const job = await jobNow();
  assert.deepEqual(job.params.foliation.weights, typed);
  const { foliation } = await reportNow();
  assert.equal(foliation.mode, 'pants');
  assert.deepEqual(foliation.weights_asked, typed);
  // Only their proportions count.
  const share = (all) => all.map((one) => one / all.reduce((sum, each) => sum + each, 0));
  share(foliation.weights).forEach((one, k) => assert.ok(Math.abs(one - share(typed)[k]) < 0.1, String(foliation.weights)));
  assert.deepEqual(desk.faults, []);
});
