// The dashboard in a real browser, from a dropped mesh to a cut sheet.
//   node run.mjs [URL]                      against a daemon that runs already
//   LEAFCUTTER_BIN=… node run.mjs           against one started for the tests, with a state of its own
//   node run.mjs                            against the made-up daemon of web/test
// Pictures go to build/screenshots, or to LEAFCUTTER_SCREENSHOTS.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { axeFaults, canvasColours, drop, kPhone, launch, openPage, picture, steady, until } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { torusOff } from './mesh.mjs';
import { step } from './story.mjs';

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

// In the page: length of everything drawn as burnt, in mm.
const burntLength = () =>
  [...document.querySelectorAll('.burn path')].reduce((sum, path) => sum + path.getTotalLength(), 0);

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

step('the mesh is seen before anything is sent', async () => {
  await desk.page.waitForSelector('.mesh-good');
  const said = await desk.page.innerText('.mesh-facts');
  assert.match(said, /960 vertices, 1,?920 faces · one piece · genus 1 · closed/);
  assert.match(said, /300 × 300 × 85/);
  await desk.page.waitForSelector('.mesh-view canvas[data-ready=true]');
  const strips = async () => Number((await desk.page.innerText('.estimate strong >> nth=0')).replace(',', ''));
  const wide = await strips();
  await desk.page.getByLabel('Strip width').fill('5');
  await until(strips, (now) => now > 1.5 * wide, 'narrower strips are more');
  await desk.page.getByLabel('Strip width').fill('10');
});

step('a place is picked on the model', async () => {
  const { page } = desk;
  const field = page.getByLabel('Singular points near', { exact: true });
  await page.locator('.pick-tool', { has: field }).getByRole('button').click();
  const canvas = page.locator('.mesh-view canvas');
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  for (const [fx, fy] of [[0.5, 0.75], [0.3, 0.55], [0.7, 0.55], [0.5, 0.3]]) {
    await page.mouse.click(box.x + fx * box.width, box.y + fy * box.height);
    if ((await field.inputValue()) !== '') break;
  }
  assert.match(await field.inputValue(), /^\d+$/);
  await picture(page, 'pick-light');
  await field.fill('');
});

step('a wrong measure is said at once and cannot be sent', async () => {
  const width = desk.page.getByLabel('Strip width');
  await width.fill('-3');
  await until(() => desk.page.innerText('.new-job [role=alert]'), (said) => /strip width/i.test(said), 'a fault that is said');
  assert.equal(await desk.page.isEnabled('.new-job [type=submit]'), false);
  await width.fill('16');
  await desk.page.getByRole('textbox', { name: 'Longest side' }).fill('200');
});

step('the layout is chosen among those that fit together', async () => {
  await desk.page.getByText('How the surface is laid out').click();
  const select = (name) => desk.page.getByRole('combobox', { name, exact: true });
  await select('Holes at the tips').selectOption('Never');
  await select('Function').waitFor();
  await select('Layout').selectOption('Closed both ways');
  await select('Function').waitFor({ state: 'detached' });
  await assertAccessible(desk.page, 'layout');
});

step('the job computes while its stages are watched', async () => {
  await desk.page.click('.new-job [type=submit]');
  await desk.page.waitForSelector('.job-page h1');
  jobAddress = desk.page.url();
  await desk.page.waitForSelector('.stage-running, .model canvas');
  if (await desk.page.isVisible('.stages')) {
    await picture(desk.page, 'computing-light');
    await assertAccessible(desk.page, 'computing');
  }
  await desk.page.waitForSelector('.model canvas[data-ready=true], .failure');
  if (await desk.page.isVisible('.failure')) assert.fail(await desk.page.innerText('.failure'));
});

step('the weave is drawn in 3D, in every mode, and turns by keyboard', async () => {
  const canvas = desk.page.locator('.model canvas');
  const seen = new Set([await canvas.evaluate((element) => element.toDataURL())]);
  const draw = () => canvas.evaluate((element) => element.toDataURL());
  const isNew = async (what) => seen.add(await until(draw, (drawn) => !seen.has(drawn), `${what}, unlike all before it`));
  for (const mode of ['Weft', 'Warp', 'Quads', 'Cylinders', 'Surface', 'Leaves', 'Quality']) {
    await desk.page.getByRole('button', { name: mode, exact: true }).click();
    await desk.page.waitForFunction(() => document.querySelector('.model .view-note') === null);
    await isNew(mode);
    await until(() => canvasColours(desk.page), (colours) => colours > 10, `colours of ${mode}`);
  }
  await canvas.focus();
  await desk.page.keyboard.press('ArrowLeft');
  await isNew('a turned model');
  assert.equal(seen.size, 9);
  await desk.page.keyboard.press('Home');
  await desk.page.getByRole('button', { name: 'Woven', exact: true }).click();
});

step('a daemon of ours gives the weave its real thickness', async () => {
  const solid = desk.page.getByRole('button', { name: 'True thickness', exact: true });
  if (target.made === 'daemon') assert.equal(await solid.count(), 1);
  if ((await solid.count()) === 0) return;
  await solid.click();
  await desk.page.waitForFunction(() => document.querySelector('.model .view-note') === null);
  await until(() => canvasColours(desk.page), (colours) => colours > 20, 'colours of a thick weave');
  await picture(desk.page, 'thickness-light');
  await desk.page.getByRole('button', { name: 'Woven', exact: true }).click();
});

step('the sheets are drawn with every piece', async () => {
  await until(() => desk.page.locator('.sheet .piece').count(), (pieces) => pieces > 3, 'pieces on the sheet');
  await picture(desk.page, 'ready-light');
  await assertAccessible(desk.page, 'ready');
});

step('the layout and how even it is are said', async () => {
  const said = () => desk.page.locator('.foliation').innerText();
  await until(said, (text) => /Closed both ways/.test(text), 'the layout');
  await until(said, (text) => /largest .*times as long as the mean/.test(text), 'how even it is');
});

step('a strip chosen in 3D lights up on its sheet, and back', async () => {
  await desk.page.locator('.model canvas').scrollIntoViewIfNeeded();
  const box = await desk.page.locator('.model canvas').boundingBox();
  for (const [fx, fy] of [[0.5, 0.72], [0.5, 0.5], [0.4, 0.65], [0.6, 0.4]]) {
    await desk.page.mouse.click(box.x + fx * box.width, box.y + fy * box.height);
    if ((await desk.page.inputValue('.strip-picker select')) !== '') break;
  }
  const chosen = await desk.page.inputValue('.strip-picker select');
  assert.notEqual(chosen, '');
  await desk.page.locator(`.piece.chosen[data-strip="${chosen}"]`).first().waitFor({ state: 'attached' });
  await picture(desk.page, 'strip-light');
  const other = desk.page.locator(`.sheet .piece:not([data-strip="${chosen}"])`).first();
  const id = await other.getAttribute('data-strip');
  await other.locator('.outline').dispatchEvent('pointerdown', { pointerId: 1 });
  await other.locator('.outline').dispatchEvent('pointerup', { pointerId: 1 });
  await until(() => desk.page.inputValue('.strip-picker select'), (now) => now === id, `strip ${id} in the list`);
});

step('a figure of the report shows where it comes from', async () => {
  await desk.page.getByRole('button', { name: 'Distance to surface' }).click();
  await desk.page.waitForSelector('.heat-bar');
  await until(() => desk.page.locator('.heat-legend select').inputValue(), (now) => now === 'distance', 'the map of the distance');
  await picture(desk.page, 'heat-light', { fullPage: false });
  await assertAccessible(desk.page, 'heat map');
  await desk.page.getByRole('button', { name: 'Woven', exact: true }).click();
});

step('the cut is played from the exact program', async () => {
  const { page } = desk;
  await page.getByRole('button', { name: 'Play the cut' }).click();
  const slider = page.getByRole('slider');
  await slider.waitFor();
  await page.waitForFunction(() => document.querySelectorAll('.burn path').length > 0);
  const end = Math.floor(Number(await slider.getAttribute('max')));
  const burnt = () => page.evaluate(`(${burntLength})()`);
  await slider.fill(String(end));
  const whole = await steady(burnt);
  await slider.fill(String(Math.round(end / 2)));
  await until(burnt, (half) => half > 0.2 * whole && half < 0.8 * whole, `about half of ${whole}`);
  await assertAccessible(page, 'playing');
  await page.locator('.playback').getByRole('button', { name: 'Close' }).click();
});

step('the sheet zooms and comes back', async () => {
  const view = () => desk.page.getAttribute('.sheet', 'viewBox');
  const whole = await view();
  await desk.page.locator('.sheets').getByRole('button', { name: 'Zoom in' }).click();
  await until(view, (now) => now !== whole, 'a part of the sheet');
  await desk.page.locator('.sheets').getByRole('button', { name: 'Whole sheet' }).click();
  await until(view, (now) => now === whole, 'the whole sheet');
  await desk.page.locator('svg.sheet').focus();
  await desk.page.keyboard.press('+');
  await until(view, (now) => now !== whole, 'a part of the sheet, by keyboard');
  await desk.page.locator('.sheets').getByRole('button', { name: 'Whole sheet' }).click();
});

step('the package can be downloaded', async () => {
  const files = desk.page.locator('.file-list a');
  await until(() => files.count(), (now) => now >= 6, 'files of the package');
  const href = await files.first().getAttribute('href');
  assert.equal((await desk.page.request.get(target.url + href)).status(), 200);
});

async function confirmBed(page) {
  const fire = page.locator('.button.fire');
  assert.equal(await fire.isEnabled(), false, 'the laser must not start before the bed was said to be clear');
  assert.match(await page.innerText('.clear-bed h2'), /sheet \d+/i);
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

step('the burnt part grows while the machine cuts; pausing holds it', async () => {
  const { page } = desk;
  await page.evaluate(`globalThis.burntLength = ${burntLength}`);
  await page.waitForFunction(() => globalThis.burntLength() > 0);
  const early = await page.evaluate(() => globalThis.burntLength());
  await page.waitForFunction((before) => globalThis.burntLength() > before, early);
  await page.getByRole('button', { name: 'Pause' }).click();
  await page.waitForSelector('.cut.state-paused');
  // What was under way when the machine held may still be drawn.
  const held = await steady(() => page.evaluate(() => globalThis.burntLength()));
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
  await phone.page.waitForSelector('.model canvas[data-ready=true]');
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
    await page.waitForSelector('.clear-bed, .cut-done');
    if (!(await next.isVisible())) break;
    await picture(page, 'next-sheet-light');
    await confirmBed(page);
    await next.waitFor({ state: 'detached' });
  }
  await page.waitForSelector('.chip-done');
  await picture(page, 'done-light');
  await assertAccessible(page, 'done');
});

step('the assembly is walked through on a phone, and the place is kept', async () => {
  const phone = await openPage(browser, `${jobAddress}/guide`, { viewport: kPhone, hasTouch: true, isMobile: true });
  const { page } = phone;
  await page.waitForSelector('.guide-picture canvas[data-ready=true]');
  const made = async (count) => until(() => page.locator('.crossing.made').count(), (now) => now === count, 'crossings made');
  assert.match(await page.innerText('.guide-at'), /Step 1 of \d+/);
  await page.getByRole('button', { name: 'Done, next' }).tap();
  await page.waitForSelector('.crossing');
  assert.match(await page.innerText('.guide-words h2'), /Weave in W\d+/);
  await page.locator('.crossing').first().tap();
  await made(1);
  await page.waitForTimeout(300);
  await picture(page, 'guide-phone', { fullPage: false });
  await assertAccessible(page, 'guide on a phone');
  assert.deepEqual(await page.evaluate(tooWide, kPhone.width), []);
  await page.reload();
  await page.waitForSelector('.crossing');
  assert.match(await page.innerText('.guide-at'), /Step 2 of \d+/);
  await made(1);
  for (const tab of ['Parts', 'All steps']) {
    await page.getByRole('button', { name: tab, exact: true }).tap();
    await assertAccessible(page, `guide, ${tab}`);
  }
  assert.deepEqual(phone.faults, []);
  await phone.close();
});

step('the guide prints every step with a picture', async () => {
  const { page, close } = await openPage(browser, `${jobAddress}/guide`);
  await page.waitForSelector('.guide-picture canvas[data-ready=true]');
  await page.evaluate(() => {
    globalThis.print = () => {
      const drawn = [...document.querySelectorAll('.printed-step canvas')].filter((canvas) => {
        const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
        return new Set(pixels).size > 20;
      });
      globalThis.printed = { steps: document.querySelectorAll('.printed-step').length, drawn: drawn.length };
    };
  });
  await page.getByRole('button', { name: 'Print', exact: true }).click();
  await page.waitForFunction(() => globalThis.printed !== undefined);
  const { steps, drawn } = await page.evaluate(() => globalThis.printed);
  assert.ok(steps > 5);
  assert.equal(drawn, steps);
  await close();
});

step('a job is woven again with other settings and laid beside the first', async () => {
  const { page } = desk;
  await page.getByRole('button', { name: 'Change and weave again' }).click();
  await page.waitForSelector('.new-job');
  await until(() => page.getByLabel('Strip width').inputValue(), (now) => now === '16', 'the width of before');
  await page.getByLabel('Strip width').fill('20');
  await page.click('.new-job [type=submit]');
  await page.waitForSelector('.model canvas[data-ready=true]');
  await page.locator('.compare-with').selectOption({ index: 1 });
  await page.waitForSelector('.compare-figures td');
  await page.waitForFunction(() => document.querySelectorAll('.model canvas[data-ready=true]').length === 2);
  const compared = () => page.innerText('.compare-page');
  await until(compared, (said) => /grid\.strip_width_mm\s+20\s+16/.test(said), 'what differs');
  await picture(page, 'compare-light');
  await assertAccessible(page, 'compare');
});

const kPages = ['', '#/queue', '#/machines', '#/materials', '#/stock', '#/settings', '#/people', '#/audit'];

test('every page is accessible in both schemes, and fits a phone', async () => {
  const wide = await openPage(browser, target.url);
  const small = await openPage(browser, target.url, { viewport: kPhone, hasTouch: true, isMobile: true });
  for (const address of kPages) {
    const name = address.slice(2) || 'jobs';
    for (const [size, { page }] of [['desk', wide], ['phone', small]]) {
      await page.goto(`${target.url}/${address}`);
      await page.waitForSelector('main h1');
      await page.waitForTimeout(400);
      for (const colorScheme of ['dark', 'light']) {
        await page.emulateMedia({ colorScheme });
        await picture(page, `${name}-${size}-${colorScheme}`);
      }
      await assertAccessible(page, `${name}, ${size}`);
    }
    assert.deepEqual(await small.page.evaluate(tooWide, kPhone.width), [], name);
  }
  if (target.made === 'fake') assert.deepEqual([...wide.faults, ...small.faults], []);
  await wide.close();
  await small.close();
});

test('windows over the page are accessible and close with Escape', async () => {
  const { page, close } = await openPage(browser, `${target.url}/#/machines`);
  for (const [address, button] of [['#/machines', 'Add a machine'], ['#/materials', 'Add a material']]) {
    await page.goto(`${target.url}/${address}`);
    await page.getByRole('button', { name: button }).click();
    await page.waitForSelector('dialog[open]');
    await assertAccessible(page, button);
    // An open list of suggestions takes the first one for itself. Never two at once: they stop the machines.
    const isThere = async () => (await page.locator('dialog').count()) > 0;
    for (let press = 0; press < 3 && (await isThere()); press += 1) {
      await page.keyboard.press('Escape');
      await page.waitForSelector('dialog', { state: 'detached', timeout: 10_000 }).catch(() => undefined);
    }
    assert.equal(await isThere(), false, button);
  }
  await close();
});

test('every language is spoken, and the choice is kept', async () => {
  const { page, faults, close } = await openPage(browser, `${target.url}/#/settings`, { locale: 'fr-FR' });
  await page.waitForFunction(() => document.documentElement.lang === 'fr');
  const heads = new Set();
  for (const language of ['en', 'de', 'es', 'fr', 'zh']) {
    await page.locator('.settings-form select').selectOption(language);
    await page.waitForFunction((tag) => document.documentElement.lang.startsWith(tag), language);
    heads.add(await until(() => page.innerText('.main-nav'), (words) => !heads.has(words), `words of its own in ${language}`));
    assert.deepEqual(await axeFaults(page), [], language);
  }
  assert.equal(heads.size, 5);
  await page.reload();
  await page.waitForFunction(() => document.documentElement.lang === 'zh-Hans');
  if (target.made === 'fake') assert.deepEqual(faults, []);
  await close();
});

test('dark can be chosen against the system', async () => {
  const { page, close } = await openPage(browser, `${target.url}/#/settings`);
  const ground = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
  const light = await ground();
  await page.getByRole('button', { name: 'Dark' }).click();
  await until(ground, (now) => now !== light, 'a dark ground');
  await page.reload();
  await page.waitForSelector('.settings-form');
  await until(ground, (now) => now !== light, 'a dark ground that is kept');
  await close();
});

test('two browsers see the same at the same time', async () => {
  const [one, other] = [await openPage(browser, target.url), await openPage(browser, target.url)];
  await other.page.waitForSelector('.job-row');
  // A job that waits can be cancelled, however slowly the pages follow.
  const queue = (word) => other.page.request.post(`${target.url}/api/v1/queue/${word}`);
  assert.equal((await queue('pause')).status(), 200);
  const rows = await other.page.locator('.job-row').count();
  await drop(one.page, [{ name: 'shared.off', text: torusOff() }]);
  await one.page.waitForSelector('.new-job');
  await one.page.click('.new-job [type=submit]');
  await other.page.waitForFunction((count) => document.querySelectorAll('.job-row').length === count, rows + 1);
  const row = other.page.locator('.job-row', { hasText: 'shared' });
  await row.waitFor();
  await one.page.getByRole('button', { name: 'Cancel', exact: true }).click();
  await row.getByText('Cancelled').waitFor();
  assert.equal((await queue('resume')).status(), 200);
  await one.close();
  await other.close();
});

test('a job is made with the keyboard alone', async () => {
  const { page, close } = await openPage(browser, target.url);
  await drop(page, [{ name: 'keys.off', text: torusOff() }]);
  await page.waitForSelector('.new-job [type=submit]');
  const submit = page.locator('.new-job [type=submit]');
  for (let press = 0; press < 80; press += 1) {
    await page.keyboard.press('Tab');
    if (await submit.evaluate((button) => button === document.activeElement)) break;
  }
  await page.keyboard.press('Enter');
  await page.waitForSelector('.job-page h1');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement !== document.body), true);
  await close();
});

test('a mesh that cannot be woven says why', async () => {
  await desk.page.goto(`${target.url}/#/`);
  await drop(desk.page, [{ name: 'broken.off', text: 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n' }]);
  await desk.page.click('.new-job [type=submit]');
  await desk.page.waitForSelector('.failure, .sending .fault');
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
  const x = async () => Number(await card.locator('.position dd').first().innerText());
  const from = await steady(x);
  await card.getByRole('button', { name: 'Right', exact: true }).click();
  await until(x, (now) => now > from + 9, `to the right of ${from}`);
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
  await page.waitForSelector('.connection-live');
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

test('a daemon that dies while a job computes is back with everything it knew', async (context) => {
  if (target.restart === undefined) return context.skip('only a daemon started here can be killed');
  const { page, close } = await openPage(browser, target.url);
  await drop(page, [{ name: 'restart.off', text: torusOff() }]);
  await page.waitForSelector('.new-job');
  await page.click('.new-job [type=submit]');
  await page.waitForSelector('.stage-running, .model canvas');
  await target.restart();
  await page.waitForSelector('.connection-live');
  await page.waitForSelector('.model canvas[data-ready=true]');
  const { jobs } = await (await fetch(`${target.url}/api/v1/jobs?limit=200`)).json();
  await page.goto(`${target.url}/#/`);
  await page.waitForFunction((count) => document.querySelectorAll('.job-row').length === count, jobs.length);
  return close();
});

test('dark looks as finished as light', async () => {
  const dark = await openPage(browser, jobAddress, { colorScheme: 'dark' });
  await dark.page.waitForSelector('.model canvas[data-ready=true]');
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

test('a node of a fleet is drained and taken up again', async (context) => {
  if (target.made !== 'fake') return context.skip('a daemon started here works alone');
  const { page, faults, close } = await openPage(browser, `${target.url}/#/machines`);
  const node = page.locator('.fleet-node', { hasText: 'attic' });
  await node.getByRole('button', { name: 'Drain' }).click();
  await node.getByText('finished').waitFor();
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'fleet-light');
  await node.getByRole('button', { name: 'Go on' }).click();
  await node.getByText('at work').waitFor();
  assert.deepEqual(faults, []);
  return close();
});
