// The dashboard of a daemon with accounts, in a real browser: the first admin, a login, users, keys, stock, the
// order of the queue, a network that is cut, a daemon that is killed meanwhile.
//   LEAFCUTTER_BIN=… node accounts.mjs

import assert from 'node:assert/strict';
import { after, before } from 'node:test';

import { axeFaults, drop, launch, openPage, picture, until } from './browser.mjs';
import { startTarget } from './daemon.mjs';
import { torusOff } from './mesh.mjs';
import { step } from './story.mjs';
import { layWire } from './wire.mjs';

const kAdmin = { name: 'ada', password: 'a horse that weaves' };
const kViewer = { name: 'eve', password: 'only looks at all of it' };

let target;
let wire; // All pages come through it.
let browser;
let desk;
let secret = ''; // Of a key that may submit.

before(async () => {
  target = await startTarget();
  assert.equal(target.made, 'daemon', 'set LEAFCUTTER_BIN');
  wire = await layWire(target.url);
  browser = await launch();
  desk = await openPage(browser, `${wire.url}/#/people`);
});

after(async () => {
  await browser?.close();
  wire?.close();
  await target?.close();
});

async function logIn(page, { name, password }) {
  await page.getByLabel('User name').fill(name);
  await page.getByRole('textbox', { name: 'Password' }).fill(password);
  await page.getByRole('button', { name: 'Log in' }).click();
}

// Presses a button that asks whether one is sure, and answers before it stops asking.
async function confirmRemoval(button, row) {
  for (let asked = 0; asked < 10 && (await row.count()) > 0; asked += 1) {
    await button.click({ timeout: 5000 }).catch(() => undefined);
    await row.waitFor({ state: 'detached', timeout: 1500 }).catch(() => undefined);
  }
  assert.equal(await row.count(), 0);
}

const withKey = () => ({ Authorization: `Bearer ${secret}` });

function submit(name) {
  const form = new FormData();
  form.append('name', name);
  form.append('params', '{}');
  form.append('mesh', new Blob([torusOff()]), `${name}.off`);
  return fetch(`${target.url}/api/v1/jobs`, { method: 'POST', body: form, headers: withKey() });
}

step('the first account is an admin, and from then on everyone is asked', async () => {
  const { page } = desk;
  await page.getByText('Nobody has an account').waitFor();
  await page.getByRole('button', { name: 'Add a user' }).click();
  await page.getByLabel('User name').fill(kAdmin.name);
  await page.getByRole('textbox', { name: 'Password' }).fill('too short');
  assert.equal(await page.getByRole('button', { name: 'Save' }).isEnabled(), false);
  await page.getByRole('textbox', { name: 'Password' }).fill(kAdmin.password);
  await page.getByRole('button', { name: 'Save' }).click();
  await page.waitForSelector('.login');
  assert.equal((await fetch(`${target.url}/api/v1/jobs`)).status, 401);
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'login-light');
});

step('a wrong password is said, the right one opens the page', async () => {
  const { page } = desk;
  await logIn(page, { ...kAdmin, password: 'not the right one' });
  await page.getByText('do not belong together').waitFor();
  await logIn(page, kAdmin);
  await page.waitForSelector('.main-nav');
  await page.waitForSelector('.connection-live');
});

step('users come and change', async () => {
  const { page } = desk;
  await page.goto(`${wire.url}/#/people`);
  await page.getByRole('button', { name: 'Add a user' }).click();
  await page.getByLabel('User name').fill(kViewer.name);
  await page.getByRole('textbox', { name: 'Password' }).fill(kViewer.password);
  await page.locator('dialog').getByLabel('May').selectOption('submit jobs');
  await page.getByRole('button', { name: 'Save' }).click();
  const role = page.getByLabel(`${kViewer.name}: May`);
  await role.waitFor();
  assert.equal(await role.inputValue(), 'submitter');
  const answer = page.waitForResponse((one) => one.url().endsWith(`/users/${kViewer.name}`));
  await role.selectOption('look');
  assert.ok((await answer).ok(), String((await answer).status()));
  await until(() => role.inputValue(), (now) => now === 'viewer', 'the new role');
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'users-light');
});

step('a key lets a program in, until it is taken away', async () => {
  const { page } = desk;
  const make = async (label) => {
    await page.getByRole('button', { name: 'Make a key' }).click();
    await page.getByLabel('What for').fill(label);
    await page.locator('dialog').getByRole('button', { name: 'Make a key' }).click();
    const shown = await page.innerText('.secret');
    await page.locator('dialog').getByRole('button', { name: 'Close' }).last().click();
    return shown;
  };
  secret = await make('a script');
  const list = () => fetch(`${target.url}/api/v1/jobs`, { headers: withKey() });
  assert.equal((await list()).status, 200);
  const row = page.locator('.person', { hasText: 'a script' });
  await row.waitFor();
  await confirmRemoval(row.getByRole('button'), row);
  assert.equal((await list()).status, 401);
  secret = await make('another');
  assert.equal((await list()).status, 200);
});

step('sheets come into stock, are drawn, and go', async () => {
  const { page } = desk;
  await page.goto(`${wire.url}/#/stock`);
  await page.getByRole('button', { name: 'Add sheets' }).click();
  await page.getByLabel('Sheet width').fill('480');
  await page.getByLabel('Sheet height').fill('320');
  await page.getByLabel('How many').fill('7');
  await page.getByRole('button', { name: 'Save' }).click();
  const card = page.locator('.stock-card', { hasText: '7 sheets' });
  await card.locator('.stock-picture path').first().waitFor();
  assert.match(await card.innerText(), /480\s×\s320\smm/);
  await confirmRemoval(card.getByRole('button', { name: /remove/i }), card);
});

step('a remnant is drawn by hand and changed later', async () => {
  const { page } = desk;
  await page.getByRole('button', { name: 'Add sheets' }).click();
  await page.getByRole('button', { name: 'Drawn' }).click();
  await page.getByRole('button', { name: 'Add a corner after corner 2' }).press('Enter');
  const corner = page.getByRole('button', { name: /^Corner 3:/ });
  for (let press = 0; press < 15; press += 1) await corner.press('Shift+ArrowLeft');
  await page.getByRole('button', { name: 'Corner 3: 450, 200 mm' }).waitFor();
  const box = await page.getByRole('button', { name: /^Corner 1:/ }).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 40, box.y + box.height / 2, { steps: 4 });
  await page.mouse.up();
  await page.getByRole('button', { name: /^Corner 1: [1-9]\d+, 0 mm/ }).waitFor();
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'outline-light');
  await page.getByRole('button', { name: 'Save' }).click();
  const card = page.locator('.stock-card', { hasText: 'remnant' });
  await card.waitFor();
  const { stock } = await (await fetch(`${target.url}/api/v1/stock`, { headers: withKey() })).json();
  const [{ outline }] = stock.filter((item) => item.kind === 'remnant');
  assert.equal(outline.length, 5);
  assert.deepEqual(outline[2], [450, 200]);
  await card.getByRole('button', { name: 'Change' }).click();
  await page.getByRole('button', { name: 'Rectangle' }).click();
  await page.getByRole('button', { name: 'Save' }).click();
  await card.waitFor({ state: 'detached' });
  await page.locator('.stock-card', { hasText: '600 × 400 mm' }).waitFor();
});

step('a paused queue keeps what comes, in an order one may change', async () => {
  const { page } = desk;
  await page.goto(`${wire.url}/#/queue`);
  await page.getByRole('button', { name: 'Pause the queue' }).click();
  await page.getByText('The queue is paused.').waitFor();
  for (const name of ['early', 'late']) assert.equal((await submit(name)).status, 201);
  const order = async () => (await page.locator('.queue-row a').allInnerTexts()).join();
  await until(order, (now) => now === 'early,late', 'both, in their order');
  await page.getByRole('button', { name: 'late: first' }).click();
  await until(order, (now) => now === 'late,early', 'the other order');
  assert.deepEqual(await axeFaults(page), []);
  await picture(page, 'queue-paused-light');
});

step('a network that was cut comes back without a lost event', async () => {
  const { page } = desk;
  await page.goto(`${wire.url}/#/`);
  await page.waitForSelector('.job-row');
  await page.evaluate(() => (globalThis.sameDocument = true));
  wire.cut();
  await page.waitForSelector('.connection-waiting');
  assert.equal((await submit('while away')).status, 201);
  wire.mend();
  await page.locator('.job-row', { hasText: 'while away' }).waitFor();
  await page.waitForSelector('.connection-live');
});

step('a daemon killed with a queue is back with it, and the login holds', async () => {
  const { page } = desk;
  await target.restart();
  await page.waitForSelector('.connection-live');
  assert.equal((await submit('after')).status, 201);
  await page.locator('.job-row', { hasText: 'after' }).waitFor();
  assert.equal(await page.locator('.job-row').count(), 4);
  assert.equal(await page.evaluate(() => globalThis.sameDocument), true, 'nobody loaded the page anew');
});

step('who may only look sees all, may stop machines, and may not begin', async () => {
  const { page, close } = await openPage(browser, wire.url);
  await logIn(page, kViewer);
  await page.waitForSelector('.job-row');
  await drop(page, [{ name: 'mine.off', text: torusOff() }]);
  await page.click('.new-job [type=submit]');
  await page.waitForSelector('.sending .fault');
  const jobs = await (await fetch(`${target.url}/api/v1/jobs`, { headers: withKey() })).json();
  assert.equal(jobs.jobs.length, 4, 'nothing was made');
  const stopped = page.waitForResponse((one) => one.url().endsWith('/commands'));
  await page.keyboard.press('Control+.');
  assert.equal((await stopped).status(), 202);
  await page.goto(`${wire.url}/#/settings`);
  await page.getByText('eve, may look').waitFor();
  await page.getByRole('button', { name: 'Log out' }).click();
  await page.waitForSelector('.login');
  await close();
});
