import type { Studio } from '../state/studio.svelte';
import { keep } from './files';

/** Keeps a report on runs as one file, which opens without a studio. */
export async function keepReport(studio: Studio, names: string[]) {
  const page = await studio.try(() => studio.engine.ask('report', { names }));
  if (page === undefined) return;
  const name = names.length === 1 ? names[0].replaceAll('/', '-') : `report-of-${names.length}-runs`;
  keep(page, `${name}.html`, 'text/html');
}
