import { expect, test } from '@playwright/test';
import { existsSync, readFileSync } from 'node:fs';
import { curveSvg } from '../src/lib/curve-svg';
import type { Stage } from '../src/view/stage';
import { add, barriers, begin, hurry, PATIENCE, taskName } from './page';

/** Nothing on the page may fail unnoticed. */
test.beforeEach(({ page }) => {
  page.on('pageerror', (error) => {
    throw error;
  });
});

test('two buttons of one’s own are set up, moved, learnt, replayed and found again', async ({ page }) => {
  await page.goto('/');
  await page.getByRole('button', { name: 'New task' }).click();
  await expect(page.getByLabel('Done by')).toHaveValue('human');
  await hurry(page);
  await add(page, 'button');
  const objects = page.getByRole('list', { name: 'Objects' });
  await expect(objects.getByRole('button', { name: /^button/ })).toBeVisible();
  await add(page, 'button');
  await expect(objects.getByRole('button')).toHaveCount(2);
  await expect(page.getByRole('list', { name: 'Steps' }).getByRole('listitem')).toHaveText([
    /press button/,
    /press button_2/,
  ]);

  const own = await taskName(page);

  // Its number is beside it: there the second button is.
  const canvas = page.locator('canvas').first();
  const label = page.locator('.labels span', { hasText: '2' });
  await expect(label).toBeVisible();
  const box = (await label.boundingBox())!;
  const before = await page.getByRole('spinbutton', { name: 'at y', exact: true }).inputValue();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + 60, box.y - 10, { steps: 6 });
  await page.mouse.up();
  const y = page.getByRole('spinbutton', { name: 'at y', exact: true });
  await expect(y).not.toHaveValue(before);
  // By steps of 5 mm.
  expect(Math.abs((Number(await y.inputValue()) / 0.005) % 1)).toBeLessThan(1e-6);
  await expect(canvas).toBeVisible();

  // One step back and one forth.
  const moved = await y.inputValue();
  await page.getByRole('button', { name: 'Undo' }).click();
  await expect(y).toHaveValue(before);
  await page.getByRole('button', { name: 'Redo' }).click();
  await expect(y).toHaveValue(moved);
  await y.fill('0.08');
  await y.press('Enter');

  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await page.getByLabel('Practice until').selectOption('0.8');
  await page.getByRole('button', { name: 'Train', exact: true }).click();
  await expect(page.getByRole('heading', { name: /Learns/ })).toBeVisible({ timeout: 60_000 });
  await page.getByRole('button', { name: 'See how it does it' }).click({ timeout: PATIENCE });

  await expect(page.getByRole('heading', { name: `${own}-1` })).toBeVisible();
  const time = page.getByRole('slider', { name: 'Time in the episode' });
  const first = Number(await time.inputValue());
  await expect.poll(async () => Number(await time.inputValue())).not.toBe(first);
  const download = page.waitForEvent('download');
  await page.getByRole('button', { name: 'CSV' }).click();
  const rows = readFileSync(await (await download).path(), 'utf8')
    .trim()
    .split('\n');
  expect(rows[0]).toMatch(/^time_s,step,fingertip_x_m,.*elbow_flexion_rad,.*DELT1_activation/);
  expect(new Set(rows.map((row) => row.split(',').length)).size).toBe(1);
  expect(Number(rows.at(-1)!.split(',')[0])).toBeGreaterThan(0.1);
  await page.getByLabel('Tags').fill('pilot');
  await page.getByLabel('Tags').blur();
  // The task that is set up is still what it was.
  await page.getByRole('button', { name: own, exact: true }).click();
  await expect(objects.getByRole('button')).toHaveCount(2);
  await page.getByRole('button', { name: 'Runs', exact: true }).click();
  await page.getByLabel('Find runs').fill('pilot');
  await expect(page.getByRole('row', { name: new RegExp(`${own}-1`) })).toContainText('evaluated');
});

test('a user that has learnt a layout goes on when it is changed', async ({ page }) => {
  await begin(page, 'public-display');
  await hurry(page);
  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await page.getByLabel('Practice until').selectOption('0.8');
  await page.getByRole('checkbox', { name: /^Live/ }).check();
  await expect(page.getByRole('heading', { name: /Has reached the goal/ })).toBeVisible({ timeout: PATIENCE });
  await page
    .getByRole('list', { name: 'Objects' })
    .getByRole('button', { name: /upper_left/ })
    .click();
  await page.getByRole('button', { name: 'Properties', exact: true }).click();
  const y = page.getByRole('spinbutton', { name: 'at y', exact: true });
  await y.fill('0.1');
  await y.press('Enter');
  await page.getByRole('button', { name: 'Training', exact: true }).click();
  await expect(page.getByText(/At first sight: .* not adapted yet/)).toBeVisible({ timeout: 20_000 });
  await expect(page.getByRole('heading', { name: /Has reached the goal/ })).toBeVisible({ timeout: PATIENCE });
  await page.getByRole('checkbox', { name: /^Live/ }).uncheck();
});

test('what is wrong is said at the field, in the words of the command line', async ({ page }) => {
  await begin(page, 'public-display');
  await page
    .getByRole('list', { name: 'Objects' })
    .getByRole('button', { name: /upper_left/ })
    .click();
  const x = page.getByRole('spinbutton', { name: 'at x', exact: true });
  await x.fill('0.9');
  await x.press('Enter');
  await expect(page.getByText(/upper_left .* out of reach|upper_left .* beyond/i).first()).toBeVisible();
  await expect(page.getByRole('button', { name: 'Train', exact: true })).toBeDisabled();
  await page.getByRole('button', { name: 'Undo' }).click();
  await expect(page.getByRole('button', { name: 'Train', exact: true })).toBeEnabled();
});

test('a file that is changed here keeps its comments', async ({ page }) => {
  await begin(page, 'slider');
  await page
    .getByRole('list', { name: 'Objects' })
    .getByRole('button', { name: /^volume/ })
    .click();
  const length = page.getByRole('spinbutton', { name: 'length', exact: true });
  await length.fill('0.12');
  await length.press('Enter');
  const file = `${process.env.MYO_STUDIO_FOLDER}/tasks/slider.yaml`;
  await expect.poll(() => existsSync(file) && readFileSync(file, 'utf8')).toContain('length: 0.12');
  const text = readFileSync(file, 'utf8');
  expect(text).toContain('# how far the handle can be moved');
  expect(text).toContain('# half way between a table and a wall');
  expect(text).toContain('range: [0, 100]');
  expect(text).toContain('- drag: {slider: volume, to: 70, within: 5}');
});

test('a task is set up with the keyboard alone', async ({ page }) => {
  await page.goto('/');
  await page.getByRole('button', { name: 'New task' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: '+ Add' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('group', { name: 'What to add' }).getByRole('button', { name: 'sphere' }).focus();
  await page.keyboard.press('Enter');
  const item = page.getByRole('list', { name: 'Objects' }).getByRole('button');
  await item.focus();
  const z = page.getByRole('spinbutton', { name: 'at z', exact: true });
  await expect(z).toHaveValue('-0.1');
  await page.keyboard.press('Alt+ArrowUp');
  await expect(z).toHaveValue('-0.095');
  await page.keyboard.press('Control+z');
  await expect(z).toHaveValue('-0.1');
  await page.keyboard.press('Delete');
  await expect(page.getByText('Nothing stands here yet')).toBeVisible();
});

for (const [size, width, height] of [
  ['wide', 1280, 720],
  ['narrow', 390, 844],
] as const) {
  for (const colorScheme of ['light', 'dark'] as const) {
    test(`everybody can use it: ${size}, ${colorScheme}`, async ({ browser }) => {
      const context = await browser.newContext({ viewport: { width, height }, colorScheme });
      const page = await context.newPage();
      await page.goto('/');
      await expect(page.getByRole('list', { name: 'Examples' }).getByRole('button', { name: /^ar / })).toBeVisible();
      expect(await barriers(page)).toEqual([]);
      await page.screenshot({ path: `test-results/shots/home-${size}-${colorScheme}.png` });
      await begin(page, 'ar');
      await page
        .getByRole('list', { name: 'Objects' })
        .getByRole('button', { name: /^high_ball/ })
        .click();
      await page.waitForTimeout(1500);
      expect(await barriers(page)).toEqual([]);
      await page.screenshot({ path: `test-results/shots/setup-${size}-${colorScheme}.png` });
      // Nothing is wider than the page.
      expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
      await page.getByRole('button', { name: 'Runs', exact: true }).click();
      await expect(page.getByRole('heading', { name: 'Runs' })).toBeVisible();
      expect(await barriers(page)).toEqual([]);
      await page.screenshot({ path: `test-results/shots/runs-${size}-${colorScheme}.png` });
      await context.close();
    });
  }
}

test('a curve that is kept as SVG says what the numbers were', async ({ page }) => {
  const [x, y] = [
    [0, 0.35, 0.9, 1.25],
    [-3, 41, null, 127.5],
  ] as const;
  const lines = [
    { name: 'a & b', y: [...y] },
    { name: 'other', y: [0, 0, 0, 0] },
  ];
  await page.setContent(curveSvg({ title: '<Angles>', xName: 'Time (s)', yName: 'Angle (°)', x: [...x], lines }));
  const read = await page.evaluate(() => {
    const ticks = (kind: string, axis: string) =>
      [...document.querySelectorAll(`.${kind}`)].map((tick) => [
        Number(tick.textContent.replace('−', '-')),
        Number(tick.getAttribute(axis)),
      ]);
    const way = document.querySelector('path')!.getAttribute('d')!;
    const points = [...way.matchAll(/([ML])([-\d.]+) ([-\d.]+)/g)];
    const names = [...document.querySelectorAll('text')].map((text) => text.textContent);
    return { x: ticks('x-tick', 'x'), y: ticks('y-tick', 'y'), points, names };
  });
  // Round numbers, and places by which the points can be read off.
  expect(read.y.map(([value]) => value)).toEqual([-50, 0, 50, 100, 150]);
  const off = ([a, b]: number[][], at: number) => a[0] + ((at - a[1]) / (b[1] - a[1])) * (b[0] - a[0]);
  const found = read.points.map(([, pen, px, py]) => [pen, off(read.x, Number(px)), off(read.y, Number(py) + 4)]);
  // What has no value leaves a gap.
  expect(found.map(([pen]) => pen)).toEqual(['M', 'L', 'M']);
  [0, 1, 3].forEach((k, index) => {
    expect(Math.abs(Number(found[index][1]) - x[k])).toBeLessThan(0.005);
    expect(Math.abs(Number(found[index][2]) - y[k]!)).toBeLessThan(0.5);
  });
  for (const name of ['<Angles>', 'Time (s)', 'Angle (°)', 'a & b', 'other']) expect(read.names).toContain(name);
});

test('a script that says the end of a name follows what is renamed and what is taken out', async ({ page }) => {
  const text = `version: 2
name: panels
scene:
  panel:
    kind: group
    at: [0.42, 0, -0.15]
    tilt_deg: 60
    objects:
      left: {kind: button, at: [0, 0.05, 0], size: [0.04, 0.04, 0.02]}
      right: {kind: button, at: [0, -0.05, 0], size: [0.04, 0.04, 0.02]}
  ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.04}
script:
  - press: left
  - press: panel.right
  - dwell: {in: ball, for_s: 0.2}
time_limit_s: 5
`;
  await page.goto('/');
  await page
    .getByLabel('Task file to import')
    .setInputFiles({ name: 'panels.yaml', mimeType: 'application/yaml', buffer: Buffer.from(text) });
  const objects = page.getByRole('list', { name: 'Objects' });
  const steps = page.getByRole('list', { name: 'Steps' });
  await objects.getByRole('button', { name: /^left/ }).click();
  const name = page.getByLabel('Name', { exact: true });
  await name.fill('west');
  await name.press('Enter');
  await expect(steps.getByRole('listitem')).toHaveText([/press panel.west/, /press panel.right/, /dwell/]);
  await expect(page.getByRole('alert')).toHaveCount(0);
  // Both at once by the arrow keys, each along the axes of its own surroundings: up in the world.
  await objects.getByRole('button', { name: /^ball/ }).click();
  await objects.getByRole('button', { name: /^west/ }).click({ modifiers: ['Shift'] });
  await page.keyboard.press('Alt+ArrowUp');
  const file = `${process.env.MYO_STUDIO_FOLDER}/tasks/panels.yaml`;
  await expect.poll(() => readFileSync(file, 'utf8')).toContain('at: [0.4, 0, 0.005]');
  // Of a face that is tilted by 60 degrees, up is half of it outwards and 0.87 of it along the face.
  const [along, , out] = /west: .*at: \[([^\]]*)\]/.exec(readFileSync(file, 'utf8'))![1].split(',').map(Number);
  expect(Math.abs(along - 0.005 * Math.sin(Math.PI / 3))).toBeLessThan(1e-5);
  expect(Math.abs(out - 0.005 * Math.cos(Math.PI / 3))).toBeLessThan(1e-5);
  await objects.getByRole('button', { name: /^panel/ }).click();
  await page.keyboard.press('Delete');
  await expect(steps.getByRole('listitem')).toHaveText([/dwell/]);
  await expect(page.getByRole('alert')).toHaveCount(0);
});

test('a hand that alone moves is seen from nearby', async ({ page }) => {
  const away = () =>
    page.evaluate(() => {
      const { camera, controls } = (window as unknown as { myoStage: Stage }).myoStage;
      return camera.position.distanceTo(controls.target);
    });
  await begin(page, 'pinch');
  await expect.poll(away).toBeLessThan(0.7);
  // With the whole arm, from where all of it is seen.
  await page.getByLabel('Body').selectOption('myo-arm');
  await expect.poll(away).toBeGreaterThan(1);
});
