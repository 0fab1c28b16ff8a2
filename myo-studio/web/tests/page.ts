import { expect, type Page } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** How long (ms) a training may take on a machine that is slow or does other things, too: what is tested is that it ends. */
export const PATIENCE = 900_000;

/** Serious findings about who cannot use the page. */
export async function barriers(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => {
    const { violations } = await (
      window as unknown as { axe: { run: () => Promise<{ violations: Violation[] }> } }
    ).axe.run();
    return violations;
  });
  const serious = found.filter(({ impact }) => impact === 'serious' || impact === 'critical');
  return serious.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(' | ')}`);
}

interface Violation {
  id: string;
  impact: string;
  nodes: { html: string }[];
}

export async function begin(page: Page, preset: string) {
  await page.goto('/');
  await page
    .getByRole('list', { name: 'Examples' })
    .getByRole('button', { name: new RegExp(`^${preset} `) })
    .click();
  await expect(page.getByRole('list', { name: 'Objects' }).getByRole('button').first()).toBeVisible();
}

/** Lets the task that is open be done by who learns it soonest: people take their time. */
export async function hurry(page: Page) {
  await page.getByLabel('Done by').selectOption('fastest');
}

export async function add(page: Page, kind: string) {
  await page.getByRole('button', { name: '+ Add' }).click();
  await page.getByRole('group', { name: 'What to add' }).getByRole('button', { name: kind, exact: true }).click();
}

/** Name of the task that is open: tests share a folder, so that it depends on those before. */
export async function taskName(page: Page): Promise<string> {
  return (await page.getByRole('navigation', { name: 'Pages' }).getByRole('button').nth(1).innerText()).trim();
}
