import type { BodyShape } from '../engine/protocol';
import type { Film } from './motion';

/** Columns and rows of a movement: time, step, fingertip, pointer, force, joints, activations. Units stand in the names. */
export function table(film: Film, body: BodyShape): { columns: string[]; rows: number[][] } {
  const axes = (name: string) => ['x', 'y', 'z'].map((axis) => `${name}_${axis}_m`);
  const columns = [
    'time_s',
    'step',
    ...axes('fingertip'),
    ...axes('pointer'),
    'force_n',
    ...body.joints.map((joint) => `${joint}_rad`),
    ...body.muscles.map((muscle) => `${muscle.name}_activation`),
  ];
  const rows = Array.from({ length: film.length }, (_, index) => {
    const { time_s, step, fingertip, pointer, force_n, joints, muscles } = film.frame(index);
    return [time_s, step, ...fingertip, ...pointer, force_n, ...joints, ...activations(muscles, body)];
  });
  return { columns, rows };
}

/** The activation of each muscle: the number behind its points. */
export function activations(muscles: Float32Array, body: BodyShape): number[] {
  let at = 0;
  return body.muscles.map(({ points }) => {
    at += 3 * points + 1;
    return muscles[at - 1];
  });
}

export function csv({ columns, rows }: { columns: string[]; rows: number[][] }): string {
  const cell = (x: number) => (Number.isNaN(x) ? '' : String(Math.round(x * 1e6) / 1e6));
  return [columns.join(','), ...rows.map((row) => row.map(cell).join(','))].join('\n') + '\n';
}
