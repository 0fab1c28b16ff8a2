/** Numbers and times as people say them. */

const UNITS: [number, string][] = [
  [1e9, 'G'],
  [1e6, 'M'],
  [1e3, 'k'],
];

/** When a user has practised enough. */
export const UNTIL: [string, string][] = [
  ['plateau', 'nothing improves any more'],
  ['0.95', '95 % of tries succeed'],
  ['0.8', '80 % of tries succeed'],
];

/** Three digits and a unit: `12.3 k`. */
export function count(x: number): string {
  const [size, unit] = UNITS.find(([size]) => Math.abs(x) >= size * 0.9995) ?? [1, ''];
  const value = x / size;
  const digits = size === 1 ? 0 : Math.abs(value) >= 99.95 ? 0 : Math.abs(value) >= 9.995 ? 1 : 2;
  return `${value.toFixed(digits)}${unit ? ` ${unit}` : ''}`;
}

export function percent(share: number | null | undefined): string {
  if (share === null || share === undefined) return '–';
  // All and none are said only where it is so.
  const value = 100 * share;
  if (share < 1 && value > 99.9) return '99.9 %';
  return `${value.toFixed(value >= 99.95 || value === 0 ? 0 : 1)} %`;
}

/** Of the strength of all muscles: `0.214 %`. */
export function ofStrength(share: number | null | undefined): string {
  return share === null || share === undefined ? '–' : `${(100 * share).toPrecision(3)} %`;
}

export function seconds(s: number | null | undefined): string {
  if (s === null || s === undefined) return '–';
  return s < 10 ? `${s.toFixed(2)} s` : `${s.toFixed(1)} s`;
}

export function duration(s: number): string {
  if (s < 60) return `${s.toFixed(s < 10 ? 1 : 0)} s`;
  const [minutes, rest] = [Math.floor(Math.round(s) / 60), Math.round(s) % 60];
  return minutes < 60 ? `${minutes} min ${rest} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** How long ago something was, from seconds since 1970. */
export function ago(since_s: number): string {
  const s = Date.now() / 1000 - since_s;
  if (s < 60) return 'just now';
  if (s < 3600) return `${Math.floor(s / 60)} min ago`;
  if (s < 86400) return `${Math.floor(s / 3600)} h ago`;
  return new Date(since_s * 1000).toLocaleDateString(undefined, { day: 'numeric', month: 'short', year: 'numeric' });
}
