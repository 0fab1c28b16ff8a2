// Where a task happens is a matter of the view alone: it is remembered beside the task, not in it.

/** Things that say where a task happens. */
export const THINGS = ['none', 'phone', 'tablet', 'wall', 'table'] as const;
export type Thing = (typeof THINGS)[number];

export interface Choice {
  thing: Thing;
  sitting: boolean;
}

const key = (task: string) => `myo-scenery ${task}`;

export function chosen(task: string): Choice {
  try {
    const kept = JSON.parse(localStorage.getItem(key(task)) ?? '{}') as Partial<Choice>;
    const thing = THINGS.find((name) => name === kept.thing) ?? 'none';
    return { thing, sitting: kept.sitting === true };
  } catch {
    // What cannot be read is as good as nothing.
    return { thing: 'none', sitting: false };
  }
}

export function remember(task: string, choice: Choice) {
  try {
    localStorage.setItem(key(task), JSON.stringify(choice));
  } catch {
    // Full, or not allowed: it holds until the page is left.
  }
}
