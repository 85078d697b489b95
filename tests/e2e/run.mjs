// The dashboard in a real browser, from a dropped mesh to a cut sheet.
//   node run.mjs [URL]                      against a daemon that runs already
//   LEAFCUTTER_BIN=… node run.mjs           against one started for the tests, with a state of its own
//   node run.mjs                            against the made-up daemon of web/test
// Pictures go to build/screenshots, or to LEAFCUTTER_SCREENSHOTS.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { axeFaults, canvasColours, drop, kPhone, launch, openPage, picture } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { torusOff } from './mesh.mjs';

const kLong = 120_000; // For computing and cutting on a busy machine.

let target;
let browser;
let desk; // The page on which the flow is played.
let jobAddress = '';

before(async () => {
  target = await startTarget();
  browser = await launch();
  desk = await openPage(browser, target.url);
  await desk.page.waitForSelector('.connection-live');
});

after(async () => {
  await browser?.close();
  await target?.close();
});

async function assertAccessible(page, where) {
  for (const colorScheme of ['dark', 'light']) {
    await page.emulateMedia({ colorScheme });
    assert.deepEqual(await axeFaults(page), [], `${where}, ${colorScheme}`);
  }
}

// The steps of one story: where one fails, those after it would only wait in vain.
let broken = '';
function step(name, act) {
  test(name, async () => {
    assert.equal(broken, '', 'an earlier step failed');
    broken = name;
    await act();
    broken = '';
  });
}

step('the first page is live and accessible', async () => {
  await picture(desk.page, 'start-light');
  await assertAccessible(desk.page, 'start');
});

step('a mesh dropped on the page opens the form with good defaults', async () => {
  await drop(desk.page, [{ name: 'torus.off', text: torusOff() }]);
  await desk.page.waitForSelector('.new-job');
  assert.equal(await desk.page.inputValue('.draft-file input'), 'torus');
  assert.equal(await desk.page.isEnabled('.new-job [type=submit]'), true);
  await picture(desk.page, 'new-light');
  await assertAccessible(desk.page, 'form');
});

step('a wrong measure is said at once and cannot be sent', async () => {
  const width = desk.page.getByLabel('Strip width');
  await width.fill('-3');
  assert.match(await desk.page.innerText('.new-job [role=alert]'), /strip width/i);
  assert.equal(await desk.page.isEnabled('.new-job [type=submit]'), false);
  await width.fill('16');
  await desk.page.getByLabel('Longest side').fill('200');
});

step('the layout is chosen among those that fit together', async () => {
  await desk.page.getByText('How the surface is laid out').click();
  const select = (name) => desk.page.getByRole('combobox', { name, exact: true });
  await select('Holes at the tips').selectOption('Never');
  assert.equal(await select('Function').isVisible(), true);
  await select('Layout').selectOption('Closed both ways');
  assert.equal(await select('Function').count(), 0);
  await assertAccessible(desk.page, 'layout');
});

step('the job computes while its stages are watched', async () => {
  await desk.page.click('.new-job [type=submit]');
  await desk.page.waitForSelector('.job-page h1');
  jobAddress = desk.page.url();
  await desk.page.waitForSelector('.stage-running, .model canvas', { timeout: kLong });
  if (await desk.page.isVisible('.stages')) {
    await picture(desk.page, 'computing-light');
    await assertAccessible(desk.page, 'computing');
  }
  await desk.page.waitForSelector('.model canvas[data-ready=true], .failure', { timeout: kLong });
  if (await desk.page.isVisible('.failure')) assert.fail(await desk.page.innerText('.failure'));
});

step('the weave is drawn in 3D, in every mode, and turns by keyboard', async () => {
  const canvas = desk.page.locator('.model canvas');
  const seen = new Set();
  for (const mode of ['Weft', 'Warp', 'Surface', 'Woven']) {
    await desk.page.getByRole('button', { name: mode, exact: true }).click();
    await desk.page.waitForTimeout(250);
    assert.ok((await canvasColours(desk.page)) > 20, mode);
    seen.add(await canvas.evaluate((element) => element.toDataURL()));
  }
  await canvas.focus();
  await desk.page.keyboard.press('ArrowLeft');
  await desk.page.waitForTimeout(250);
  seen.add(await canvas.evaluate((element) => element.toDataURL()));
  assert.equal(seen.size, 5);
  await desk.page.keyboard.press('Home');
});

step('a daemon of ours gives the weave its real thickness', async () => {
  const solid = desk.page.getByRole('button', { name: 'True thickness', exact: true });
  if (target.made === 'daemon') assert.equal(await solid.count(), 1);
  if ((await solid.count()) === 0) return;
  await solid.click();
  await desk.page.waitForFunction(() => document.querySelector('.model .view-note') === null);
  await desk.page.waitForTimeout(500);
  assert.ok((await canvasColours(desk.page)) > 20);
  await picture(desk.page, 'thickness-light');
  await desk.page.getByRole('button', { name: 'Woven', exact: true }).click();
});

step('the sheets are drawn with every piece', async () => {
  assert.ok((await desk.page.locator('.sheet .piece').count()) > 3);
  await picture(desk.page, 'ready-light');
  await assertAccessible(desk.page, 'ready');
});

step('the layout and how even it is are said', async () => {
  const panel = desk.page.locator('.foliation');
  assert.match(await panel.innerText(), /Closed both ways/);
  assert.match(await panel.innerText(), /largest .*times as long as the mean/);
});

step('a strip chosen in 3D lights up on its sheet, and back', async () => {
  const box = await desk.page.locator('.model canvas').boundingBox();
  await desk.page.locator('.model canvas').scrollIntoViewIfNeeded();
  for (const [fx, fy] of [[0.5, 0.72], [0.5, 0.5], [0.4, 0.65], [0.6, 0.4]]) {
    await desk.page.mouse.click(box.x + fx * box.width, box.y + fy * box.height);
    if ((await desk.page.inputValue('.strip-picker select')) !== '') break;
  }
  const chosen = await desk.page.inputValue('.strip-picker select');
  assert.notEqual(chosen, '');
  assert.ok((await desk.page.locator(`.piece.chosen[data-strip="${chosen}"]`).count()) > 0);
  await picture(desk.page, 'strip-light');
  const other = desk.page.locator(`.sheet .piece:not([data-strip="${chosen}"])`).first();
  const id = await other.getAttribute('data-strip');
  await other.locator('.outline').dispatchEvent('pointerdown', { pointerId: 1 });
  await other.locator('.outline').dispatchEvent('pointerup', { pointerId: 1 });
  assert.equal(await desk.page.inputValue('.strip-picker select'), id);
});

step('the sheet zooms and comes back', async () => {
  const view = () => desk.page.getAttribute('.sheet', 'viewBox');
  const whole = await view();
  await desk.page.locator('.sheets').getByRole('button', { name: 'Zoom in' }).click();
  assert.notEqual(await view(), whole);
  await desk.page.locator('.sheets').getByRole('button', { name: 'Whole sheet' }).click();
  assert.equal(await view(), whole);
});

step('the package can be downloaded', async () => {
  const files = desk.page.locator('.file-list a');
  assert.ok((await files.count()) >= 6);
  const href = await files.first().getAttribute('href');
  assert.equal((await desk.page.request.get(target.url + href)).status(), 200);
});

async function confirmBed(page) {
  const fire = page.locator('.button.fire');
  assert.equal(await fire.isEnabled(), false, 'the laser must not start before the bed was said to be clear');
  assert.match(await page.innerText('.clear-bed h3'), /sheet \d+/i);
  assert.match(await page.innerText('.clear-bed code'), /^[0-9a-f]{12}$/);
  // By keyboard alone, as with one hand at the machine.
  await page.focus('.tick input');
  await page.keyboard.press('Space');
  await page.keyboard.press('Tab');
  assert.equal(await fire.evaluate((button) => button === document.activeElement), true);
  await page.keyboard.press('Enter');
}

step('nothing burns before the operator says that the bed is clear', async () => {
  if (target.device) await desk.page.selectOption('.cut-queue select', { label: target.device });
  await desk.page.getByRole('button', { name: 'Queue the cut' }).click();
  await desk.page.waitForSelector('.clear-bed');
  await picture(desk.page, 'armed-light');
  await assertAccessible(desk.page, 'armed');
  await confirmBed(desk.page);
  await desk.page.waitForSelector('.cut.state-cutting');
});

// Length of everything drawn as burnt, in mm.
const burntLength = () =>
  [...document.querySelectorAll('.burn path')].reduce((sum, path) => sum + path.getTotalLength(), 0);

step('the burnt part grows while the machine cuts; pausing holds it', async () => {
  const { page } = desk;
  await page.evaluate(`globalThis.burntLength = ${burntLength}`);
  await page.waitForFunction(() => globalThis.burntLength() > 0, null, { timeout: kLong });
  const early = await page.evaluate(() => globalThis.burntLength());
  await page.waitForFunction((before) => globalThis.burntLength() > before, early);
  await page.getByRole('button', { name: 'Pause' }).click();
  await page.waitForSelector('.cut.state-paused');
  await page.waitForTimeout(300);
  const held = await page.evaluate(() => globalThis.burntLength());
  await assertAccessible(page, 'paused');
  assert.equal(await page.evaluate(() => globalThis.burntLength()), held);
  await page.getByRole('button', { name: 'Resume' }).click();
  await page.waitForSelector('.cut.state-cutting');
  await picture(page, 'cutting-light', { fullPage: false });
});

// In the page: what makes it wider than its screen, if anything does.
const tooWide = (screen) => {
  if (document.documentElement.scrollWidth <= screen) return [];
  return [...document.querySelectorAll('body *')]
    .filter((element) => element.getBoundingClientRect().right > screen + 0.5)
    .map((element) => `${element.tagName}.${element.className} ${Math.round(element.getBoundingClientRect().right)}`);
};

step('a phone shows the same cut, and nothing is wider than the screen', async () => {
  const phone = await openPage(browser, jobAddress, { viewport: kPhone, hasTouch: true, isMobile: true });
  await phone.page.waitForSelector('.model canvas[data-ready=true]', { timeout: kLong });
  await phone.page.waitForTimeout(400);
  await picture(phone.page, 'job-phone');
  await assertAccessible(phone.page, 'job on a phone');
  for (const page of ['', '#/machines', jobAddress.slice(jobAddress.indexOf('#'))]) {
    await phone.page.goto(`${target.url}/${page}`);
    await phone.page.waitForSelector('.stop');
    // A page may be wider for a moment while its pictures come.
    const fits = (screen) => document.documentElement.scrollWidth <= screen;
    await phone.page.waitForFunction(fits, kPhone.width, { timeout: 5000 }).catch(() => undefined);
    assert.deepEqual(await phone.page.evaluate(tooWide, kPhone.width), [], page);
    assert.ok(await phone.page.isVisible('.stop'));
    await phone.page.waitForTimeout(200);
    if (page === '') await picture(phone.page, 'start-phone');
    if (page === '#/machines') await picture(phone.page, 'machines-phone');
  }
  await drop(phone.page, [{ name: 'torus.off', text: torusOff() }]);
  await phone.page.waitForSelector('.new-job');
  await picture(phone.page, 'new-phone');
  assert.ok((await phone.page.evaluate(() => document.documentElement.scrollWidth)) <= kPhone.width, 'form');
  await assertAccessible(phone.page, 'form on a phone');
  await phone.close();
});

step('every sheet is confirmed and cut until the job is done', async () => {
  const { page } = desk;
  for (let sheet = 0; sheet < 40; sheet += 1) {
    const next = page.locator('.clear-bed');
    await page.waitForSelector('.clear-bed, .cut-done', { timeout: kLong });
    if (!(await next.isVisible())) break;
    await picture(page, 'next-sheet-light');
    await confirmBed(page);
    await next.waitFor({ state: 'detached', timeout: kLong });
  }
  await page.waitForSelector('.chip-done', { timeout: kLong });
  await picture(page, 'done-light');
  await assertAccessible(page, 'done');
});

test('a mesh that cannot be woven says why', async () => {
  await desk.page.goto(`${target.url}/#/`);
  await drop(desk.page, [{ name: 'broken.off', text: 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n' }]);
  await desk.page.click('.new-job [type=submit]');
  await desk.page.waitForSelector('.failure, .sending .fault', { timeout: kLong });
  const said = await desk.page.innerText('.failure, .sending .fault');
  assert.ok(said.trim().length > 20, said);
  await picture(desk.page, 'failed-light');
  await assertAccessible(desk.page, 'failed');
});

test('the machine card shows the head and moves it', async () => {
  await desk.page.goto(`${target.url}/#/machines`);
  const card = desk.page.locator('.machine', { has: desk.page.locator('.jog-pad') }).first();
  await card.waitFor();
  await picture(desk.page, 'machines-light');
  await assertAccessible(desk.page, 'machines');
  const x = () => card.locator('.position dd').first().innerText();
  const from = Number(await x());
  await card.getByRole('button', { name: 'Right', exact: true }).click();
  await desk.page.waitForFunction(
    (before) => Number(document.querySelector('.machine .position dd')?.textContent) > before + 9, from,
  );
});

test('STOP reaches the machine while the event stream is down', async () => {
  const { page, close } = await openPage(browser, target.url);
  await page.route('**/api/v1/events', (route) => route.abort());
  await page.reload();
  await page.waitForSelector('.connection-waiting');
  await page.waitForSelector('.stop');
  const answer = page.waitForResponse((response) => response.url().endsWith('/commands'));
  await page.keyboard.press('Control+.');
  assert.equal((await answer).status(), 202);
  assert.deepEqual((await answer).request().postDataJSON(), { command: 'stop' });
  await page.waitForSelector('.notice-said');
  await page.unroute('**/api/v1/events');
  await page.waitForSelector('.connection-live', { timeout: 15_000 });
  await close();
});

test('the flow left no error in the console', () => {
  assert.deepEqual(desk.faults, []);
});

test('a lost stream comes back without a lost event', async (context) => {
  if (target.made !== 'fake') return context.skip('only the made-up daemon drops streams on demand');
  const { page, close } = await openPage(browser, target.url);
  await page.waitForSelector('.job-row');
  const rows = await page.locator('.job-row').count();
  target.dropStreams();
  const form = new FormData();
  form.append('name', 'meanwhile');
  form.append('params', '{}');
  form.append('mesh', new Blob([torusOff()]), 'meanwhile.off');
  assert.equal((await fetch(`${target.url}/api/v1/jobs`, { method: 'POST', body: form })).status, 201);
  await page.waitForFunction((count) => document.querySelectorAll('.job-row').length === count, rows + 1);
  await page.waitForSelector('.connection-live');
  return close();
});

test('dark looks as finished as light', async () => {
  const dark = await openPage(browser, jobAddress, { colorScheme: 'dark' });
  await dark.page.waitForSelector('.model canvas[data-ready=true]', { timeout: kLong });
  await dark.page.waitForTimeout(500);
  await picture(dark.page, 'done-dark');
  for (const [name, page] of [['start-dark', '#/'], ['machines-dark', '#/machines']]) {
    await dark.page.goto(`${target.url}/${page}`);
    await dark.page.waitForTimeout(300);
    await picture(dark.page, name);
  }
  await drop(dark.page, [{ name: 'torus.off', text: torusOff() }]);
  await dark.page.waitForSelector('.new-job');
  await picture(dark.page, 'new-dark');
  assert.deepEqual(dark.faults, []);
  await dark.close();
});
