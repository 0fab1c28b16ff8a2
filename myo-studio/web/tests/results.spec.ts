import { expect, test, type Page } from '@playwright/test';
import { existsSync, mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { add, barriers, begin, hurry, PATIENCE, taskName } from './page';

test.beforeEach(({ page }) => {
  page.on('pageerror', (error) => {
    throw error;
  });
});

/** A task that is learnt in seconds: one large sphere before the shoulder. */
async function easyTask(page: Page) {
  await page.goto('/');
  await page.getByRole('button', { name: 'New task' }).click();
  await hurry(page);
  await add(page, 'sphere');
  await page.getByRole('list', { name: 'Objects' }).getByRole('button').first().click();
  const radius = page.getByRole('spinbutton', { name: 'radius', exact: true });
  await radius.fill('0.15');
  await radius.press('Enter');
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();
  return taskName(page);
}

test('what if: a variant is held against its task, and the report opens without a studio', async ({
  page,
  browser,
}) => {
  const name = await easyTask(page);
  await page.getByRole('button', { name: 'What if', exact: true }).click();
  await page.getByRole('button', { name: `Try a variant of ${name}`, exact: true }).click();
  await page.getByRole('list', { name: 'Objects' }).getByRole('button').first().click();
  const y = page.getByRole('spinbutton', { name: 'at y', exact: true });
  await y.fill('0.1');
  await y.press('Enter');
  await expect(page.getByText('Saved', { exact: true })).toBeVisible();

  await page.getByRole('button', { name: 'What if', exact: true }).click();
  await page.getByLabel('Users of each').fill('1');
  await page.getByLabel('Practice until').selectOption('0.8');
  await page.getByRole('button', { name: 'Train 2 users' }).click();
  await expect(page.getByRole('button', { name: 'All are trained' })).toBeVisible();
  const table = page.getByRole('region', { name: 'Layouts' });
  await expect(table.getByRole('button', { name: /users of/ })).toHaveCount(2, { timeout: PATIENCE });
  await expect(page.getByText(/with a single user of a layout nobody can tell/).first()).toBeVisible();
  await table.getByRole('button', { name: new RegExp(`users of ${name}$`) }).click();
  await expect(table.getByRole('button', { name: `${name}-1`, exact: true })).toBeVisible();
  expect(await barriers(page)).toEqual([]);

  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Report (HTML)' }).click();
  const file = join(mkdtempSync(join(tmpdir(), 'myo-report-')), 'report.html');
  await (await download).saveAs(file);

  // From disk, in a browser that may ask nobody anything.
  const context = await browser.newContext({ offline: true });
  const report = await context.newPage();
  const failed: string[] = [];
  report.on('pageerror', (error) => failed.push(error.message));
  report.on('request', (request) => !/^(file|blob|data):/.test(request.url()) && failed.push(request.url()));
  await report.goto(pathToFileURL(file).href);
  await expect(report.getByRole('heading', { name: 'Layouts side by side' })).toBeVisible();
  await report.getByLabel('Show').selectOption(`${name}-1`);
  await expect(report.getByRole('heading', { name: `${name}-1` })).toBeVisible();
  const time = report.getByRole('slider', { name: 'Time in the episode' });
  await expect.poll(async () => Number(await time.getAttribute('max'))).toBeGreaterThan(0.1);
  await expect(report.getByLabel('Tags')).toHaveCount(0);
  expect(await barriers(report)).toEqual([]);
  expect(failed).toEqual([]);
  await context.close();
});

test('a reward is weighed, bounded and drawn, and a user goes on with other weights', async ({ page }) => {
  const name = await easyTask(page);
  await page.getByRole('button', { name: 'Reward', exact: true }).click();
  const terms = page.getByRole('list', { name: 'Terms of the reward' });
  await expect(terms.getByText('0 to +3 in a decision, 0 to +3 in an episode')).toBeVisible();
  const bonus = terms.getByRole('spinbutton', { name: 'Weight: Bonus for each target' });
  await bonus.fill('5');
  await bonus.press('Enter');
  await expect(terms.getByText('0 to +5 in a decision, 0 to +5 in an episode')).toBeVisible();
  await page.getByLabel('Show in space what distance costs').check();
  await expect(page.getByText(/per second$/)).toBeVisible();
  expect(await barriers(page)).toEqual([]);

  await page.getByRole('button', { name: 'Properties', exact: true }).click();
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await page.getByRole('button', { name: 'Train', exact: true }).click();
  await expect(page.getByRole('heading', { name: /Learns/ })).toBeVisible({ timeout: 60_000 });
  await page.getByRole('button', { name: 'Reward', exact: true }).click();
  const effort = terms.getByRole('spinbutton', { name: 'Weight: Muscle effort' });
  await effort.fill('0.04');
  await effort.press('Enter');
  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await page.getByRole('button', { name: 'Go on with this' }).click();
  await expect(page.getByText(/At first sight: .* not adapted yet/)).toBeVisible({ timeout: 30_000 });
  const config = `${process.env.MYO_STUDIO_FOLDER}/runs/${name}-1/config.json`;
  const weight = () => existsSync(config) && JSON.parse(readFileSync(config, 'utf8')).run.task.reward.effort_cost;
  await expect.poll(weight).toBe(0.04);
  await page.getByRole('button', { name: 'Stop', exact: true }).click();
  await expect(page.getByRole('heading', { name: /Stopped/ })).toBeVisible({ timeout: 30_000 });
});

test('settings of the learner are told, changed, and refused in words', async ({ page }) => {
  await begin(page, 'public-display');
  await page.getByLabel('Advanced').check();
  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await page.getByText(/^Learner/).click();
  const clip = page.getByLabel('clip', { exact: true });
  await expect(clip).toHaveValue('0.2');
  await expect(page.getByText(/Allowed: finite and greater than 0\./).first()).toBeVisible();
  await clip.fill('-1');
  await clip.press('Enter');
  await expect(page.getByText('Learner · 1 changed')).toBeVisible();
  await page.getByRole('button', { name: 'Train', exact: true }).click();
  await expect(page.getByRole('alert')).toContainText('clip is -1.0; it must be finite and greater than 0');
  await page.getByRole('button', { name: 'All as they come' }).click();
  await expect(clip).toHaveValue('0.2');
});
