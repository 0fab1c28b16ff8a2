// Takes the pictures of docs/wishes.md from a studio that is up: `npm run pictures`, or `npm run pictures -- ADDRESS`.
// The studio should work in an empty folder: what is trained here stays there.
import { chromium } from '@playwright/test';
import { mkdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const address = process.argv[2] ?? 'http://127.0.0.1:7117/';
const folder = fileURLToPath(new URL('../../../docs/pictures/', import.meta.url));
mkdirSync(folder, { recursive: true });

const browser = await chromium.launch({
  executablePath: process.env.MYO_BROWSER ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({ viewport: { width: 1200, height: 720 } });
const button = (name, exact = true) => page.getByRole('button', { name, exact });
const objects = page.getByRole('list', { name: 'Objects' });

async function keep(name) {
  await page.waitForTimeout(1500);
  await page.screenshot({ path: `${folder}${name}.jpg`, type: 'jpeg', quality: 82 });
  console.log(name);
}

async function open(preset) {
  await page.goto(address);
  await page
    .getByRole('list', { name: 'Examples' })
    .getByRole('button', { name: new RegExp(`^${preset} `) })
    .click();
  await objects.getByRole('button').first().waitFor();
}

async function add(kind) {
  await button('+ Add').click();
  await page.getByRole('group', { name: 'What to add' }).getByRole('button', { name: kind, exact: true }).click();
}

async function put(field, value) {
  const input = page.getByRole('spinbutton', { name: field, exact: true });
  await input.fill(String(value));
  await input.press('Enter');
}

await page.goto(address);
await page.waitForTimeout(4000);
await keep('home');

await open('public-display');
await objects.getByRole('button', { name: /^upper_left/ }).click();
await keep('set-up');
await page
  .getByLabel('Advanced')
  .check()
  .catch(() => {});
await keep('fields');
await put('at x', 0.75);
await button('Reach').click();
await keep('reach');
await button('Undo').click();
await button('Reach').click();

await button('Reward').first().click();
await page.getByLabel('Show in space what distance costs').check();
await keep('reward');
await page.getByLabel('Show in space what distance costs').uncheck();

await button('Training').first().click();
await page.getByLabel('Practice until').selectOption('0.95');
await button('Train').click();
await page.getByRole('heading', { name: /Learns/ }).waitFor({ timeout: 60_000 });
await page.waitForTimeout(12_000);
await page.getByRole('button', { name: 'What do these mean?' }).click();
await keep('training');
await button('Reward').first().click();
const effort = page.getByRole('spinbutton', { name: 'Weight: Muscle effort' });
await effort.fill('0.003');
await effort.press('Enter');
await button('Training').first().click();
await button('Go on with this').click();
await page.getByText(/At first sight/).waitFor({ timeout: 60_000 });
await keep('weights');
await page.getByRole('button', { name: 'See how it does it' }).click({ timeout: 400_000 });
await page.waitForTimeout(2000);
await button('Pause').click();
await page.getByRole('slider', { name: 'Time in the episode' }).fill('0.5');
await keep('replay');

await page.goto(address);
await button('New task').click();
await add('grid');
await button('Focus').click();
await keep('grid');
await page.goto(address);
await button('New task').click();
await add('keyboard');
await page.getByLabel('Labels').selectOption('names');
await button('Above').click();
await button('Focus').click();
await keep('keyboard');

await browser.close();
