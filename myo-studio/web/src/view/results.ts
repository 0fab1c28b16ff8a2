import type { TargetResult, TaskView } from '../engine/protocol';

/** How an object was done: the mean of the steps that ask for it. */
export interface Result {
  success: number;
  time_s: number | undefined;
  effort: number | undefined;
}

/** What stands beside the objects. */
export type Telling = 'steps' | 'names' | 'success' | 'time' | 'effort' | 'nothing';

/** From so much success on it is good, and middling. */
export const GOOD = 0.95;
export const MIDDLING = 0.8;

/** Apart in lightness as well as in colour, for those who do not see the colours and for print. */
const LIGHT = { good: 0x2c8f6f, middling: 0xe0a526, bad: 0x9c2318, quick: 0xb9d3f0, slow: 0x17427d };
const DARK = { good: 0x58b795, middling: 0xf0c25a, bad: 0xc9483b, quick: 0xd2e4fa, slow: 0x2f64ab };

export const tones = (dark: boolean) => (dark ? DARK : LIGHT);

/** How each object of a task was done; none where no step asks for it. Effort is known later, or not at all. */
export function results(
  task: TaskView,
  targets: TargetResult[],
  efforts: (number | null)[] = [],
): (Result | undefined)[] {
  return task.objects.map(({ steps }) => {
    const own = steps.flatMap((step) => targets[step] ?? []);
    if (own.length === 0) return undefined;
    const times = own.flatMap((target) => target.movement_time_s ?? []);
    return {
      success: mean(own.map((target) => target.success)),
      time_s: meanOfSome(times),
      effort: meanOfSome(steps.flatMap((step) => efforts[step] ?? [])),
    };
  });
}

/** What is told on a scale from little to much, of a result. */
const amount = (result: Result | undefined, telling: Telling) =>
  telling === 'effort' ? result?.effort : telling === 'time' ? result?.time_s : undefined;

/** From the least to the greatest; a few much greater ones aside, which would leave all others alike. */
export function range(
  all: (Result | undefined)[],
  telling: Telling,
): { least: number; most: number; isCut: boolean } | undefined {
  const amounts = all.flatMap((result) => amount(result, telling) ?? []).sort((a, b) => a - b);
  if (amounts.length === 0) return undefined;
  const [least, greatest] = [amounts[0], amounts.at(-1)!];
  const quarter = (count: number) => amounts[Math.floor((count * (amounts.length - 1)) / 4)];
  const fence = quarter(3) + 1.5 * (quarter(3) - quarter(1));
  const isCut = amounts.length >= 8 && greatest > fence && fence > least;
  return { least, most: isCut ? fence : greatest, isCut };
}

/** What each object is painted like to tell its success, its time or its effort. */
export function tint(all: (Result | undefined)[], telling: Telling, dark: boolean): (number | undefined)[] | undefined {
  const palette = tones(dark);
  if (telling === 'success') return all.map((result) => result && palette[grade(result.success)]);
  const ends = range(all, telling);
  if (!ends) return undefined;
  return all.map((result) => {
    const own = amount(result, telling);
    if (own === undefined) return undefined;
    const part = ends.most > ends.least ? (own - ends.least) / (ends.most - ends.least) : 0.5;
    return mixed(palette.quick, palette.slow, Math.min(1, part));
  });
}

export function grade(success: number): 'good' | 'middling' | 'bad' {
  return success >= GOOD ? 'good' : success >= MIDDLING ? 'middling' : 'bad';
}

/** What the colours say, row by row. */
export function key(all: (Result | undefined)[], telling: Telling, dark: boolean) {
  const palette = tones(dark);
  const ends = range(all, telling);
  const row = (tone: number, text: string) => ({ tone: css(tone), text });
  if (telling === 'success') {
    const rows = [
      row(palette.good, `${100 * GOOD} % or more`),
      row(palette.middling, `${100 * MIDDLING} % or more`),
      row(palette.bad, 'less'),
    ];
    return { heading: 'Success', rows };
  }
  if (!ends) return undefined;
  const show = telling === 'effort' ? effort : time;
  const greatest = `${show(ends.most)}${ends.isCut ? ' or more' : ''}`;
  const heading = telling === 'effort' ? 'Effort' : 'Movement time';
  return { heading, rows: [row(palette.quick, show(ends.least)), row(palette.slow, greatest)] };
}

/** `98 %`: all and none are said only where it is so. */
export function share(success: number): string {
  const whole = Math.round(100 * success);
  if (success < 1 && whole === 100) return '> 99 %';
  if (success > 0 && whole === 0) return '< 1 %';
  return `${whole} %`;
}

export const effort = (value: number | undefined) => (value === undefined ? '–' : value.toFixed(3));

export const time = (s: number | undefined) => (s === undefined ? '–' : `${s.toFixed(2)} s`);

/** A colour as style sheets write it. */
export const css = (tone: number) => `#${tone.toString(16).padStart(6, '0')}`;

const meanOfSome = (list: number[]) => (list.length > 0 ? mean(list) : undefined);

function mean(list: number[]): number {
  return list.reduce((sum, x) => sum + x, 0) / list.length;
}

function mixed(a: number, b: number, part: number): number {
  const channel = (shift: number) => {
    const [from, to] = [(a >> shift) & 255, (b >> shift) & 255];
    return Math.round(from + (to - from) * part) << shift;
  };
  return channel(16) | channel(8) | channel(0);
}
