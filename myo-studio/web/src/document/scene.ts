import { isMap, isScalar, isSeq, type Document, type YAMLMap } from 'yaml';
import type { ItemView } from '../engine/protocol';
import { flow, setIn, type TaskDocument, type Value } from './document.svelte';
import { keys, type Keys } from './path';

/** Edits of a scene that are more than a value. */

export type Kind =
  'sphere' | 'button' | 'obstacle' | 'slider' | 'stick' | 'grid' | 'arc' | 'circle' | 'keyboard' | 'group';

/** What a new object of each kind is: something of a usual size within easy reach. */
const NEW: Record<Exclude<Kind, 'group'>, { [key: string]: Value }> = {
  sphere: { kind: 'sphere', at: [0.4, 0, -0.1], radius: 0.04 },
  button: { kind: 'button', at: [0.42, 0, -0.15], size: [0.05, 0.05, 0.02], tilt_deg: 60 },
  obstacle: { kind: 'obstacle', at: [0.46, 0, -0.15], size: [0.4, 0.3, 0.02], tilt_deg: 90 },
  slider: { kind: 'slider', at: [0.42, 0, -0.15], tilt_deg: 45, length: 0.1, range: [0, 100], value: 0 },
  stick: { kind: 'stick', at: [0.4, 0, -0.3], length: 0.1 },
  grid: {
    kind: 'grid',
    at: [0.42, 0, -0.15],
    tilt_deg: 60,
    rows: 2,
    columns: 3,
    pitch: 0.06,
    of: { kind: 'button', size: [0.045, 0.045, 0.02] },
  },
  arc: { kind: 'arc', at: [0.2, 0, -0.2], count: 5, radius: 0.25, of: { kind: 'button', size: [0.04, 0.04, 0.02] } },
  circle: {
    kind: 'circle',
    at: [0.45, 0, -0.1],
    tilt_deg: 90,
    count: 7,
    diameter: 0.2,
    of: { kind: 'sphere', radius: 0.02, min_distance_from_previous: 0 },
  },
  keyboard: { kind: 'keyboard', at: [0.32, 0, -0.3], pitch: 0.019, key: 0.016, min_force_n: 0.5 },
};

export const KINDS = Object.keys(NEW) as Exclude<Kind, 'group'>[];

/** Adds an object of a kind and a step that asks for it; the path of the object. */
export function add(document: TaskDocument, kind: Exclude<Kind, 'group'>): string {
  let name = '';
  document.edit((tree) => {
    const scene = sceneOf(tree, ['scene']);
    name = freeName(scene, kind);
    const item = { ...NEW[kind], at: freePlace(tree, NEW[kind].at as number[]) };
    scene.set(name, block(tree, item));
    const step = stepFor(kind, name);
    if (step) addStepTo(tree, step);
  });
  return `scene.${name}`;
}

/** What is done with a new object; nothing with an obstacle. */
export function stepFor(kind: string, name: string): Value | undefined {
  switch (kind) {
    case 'sphere':
    case 'circle':
      return { dwell: { in: name, for_s: 0.25 } };
    case 'button':
    case 'grid':
    case 'arc':
      return { press: name };
    case 'slider':
      return { drag: { slider: name, to: 70, within: 5 } };
    case 'stick':
      return { swing: { stick: name, to_deg: 30, within_deg: 5 } };
    case 'keyboard':
      return { type: 'hi' };
    default:
      return undefined;
  }
}

/** Copies an object beside itself; the path of the copy. */
export function duplicate(document: TaskDocument, item: ItemView): string {
  let copy = '';
  document.edit((tree) => {
    const at = keys(item.path);
    const scene = tree.getIn(at.slice(0, -1)) as YAMLMap;
    const name = freeName(scene, String(at.at(-1)).replace(/_?\d+$/, ''));
    const node = (tree.getIn(at, true) as YAMLMap).clone() as YAMLMap;
    scene.set(name, node);
    copy = [...at.slice(0, -1), name].join('.');
    // So far to the right that it does not stand in the first.
    moveBy(tree, keys(copy), [0, -0.08, 0]);
  });
  return copy;
}

/** Takes an item out, and the steps that ask for it alone; `within` are the names of its objects. */
export function remove(document: TaskDocument, item: ItemView, within: string[]) {
  document.edit((tree) => {
    const at = keys(item.path);
    if (!tree.hasIn(at)) return;
    tree.deleteIn(at);
    forget(tree, [item.name, ...within]);
  });
}

/** Puts objects of one group into a new group, where they stand; its path. */
export function group(document: TaskDocument, items: ItemView[]): string {
  const [first] = items;
  if (!first) return '';
  const within = keys(first.path).slice(0, -1);
  let made = '';
  document.edit((tree) => {
    const scene = tree.getIn(within) as YAMLMap;
    const name = freeName(scene, 'group');
    const objects = tree.createNode({}) as YAMLMap;
    for (const item of items) {
      const own = keys(item.path);
      objects.set(own.at(-1), tree.getIn(own, true));
      tree.deleteIn(own);
    }
    const node = tree.createNode({ kind: 'group' }) as YAMLMap;
    node.set('objects', objects);
    scene.set(name, node);
    made = [...within, name].join('.');
    const prefix = prefixOf(first.name);
    items.forEach((item) => rename(tree, item.name, `${prefix}${name}.${keys(item.path).at(-1)}`));
  });
  return made;
}

/** Lines objects up with the first along an axis of what is around them. */
export function align(document: TaskDocument, items: ItemView[], axis: 0 | 1 | 2) {
  const [first, ...others] = items;
  if (!first) return;
  document.edit((tree) => {
    const target = place(tree, keys(first.path))[axis];
    for (const item of others) {
      const by = [0, 0, 0] as [number, number, number];
      by[axis] = target - place(tree, keys(item.path))[axis];
      moveBy(tree, keys(item.path), by);
    }
  });
}

/** Spreads objects evenly between the first and the last along an axis. */
export function distribute(document: TaskDocument, items: ItemView[], axis: 0 | 1 | 2) {
  document.edit((tree) => {
    const where = items.map((item) => ({ at: keys(item.path), now: place(tree, keys(item.path))[axis] }));
    where.sort((a, b) => a.now - b.now);
    const [from, to] = [where[0].now, where[where.length - 1].now];
    where.forEach(({ at, now }, index) => {
      const by = [0, 0, 0] as [number, number, number];
      by[axis] = from + ((to - from) * index) / (where.length - 1) - now;
      moveBy(tree, at, by);
    });
  });
}

/** Moves an object by so much along the axes its place is written in; ranges move as they are. */
export function moveBy(tree: Document, item: Keys, by: [number, number, number]) {
  const at = tree.getIn([...item, 'at'], true);
  if (at === undefined) {
    setIn(tree, [...item, 'at'], by);
    return;
  }
  (['x', 'y', 'z'] as const).forEach((letter, axis) => {
    if (by[axis] === 0) return;
    const key = isMap(at) ? letter : axis;
    const own = [...item, 'at', key];
    const value = tree.getIn(own, true);
    if (isSeq(value)) {
      [0, 1].forEach((end) => setIn(tree, [...own, end], Number(tree.getIn([...own, end])) + by[axis]));
    } else {
      setIn(tree, own, (isScalar(value) ? Number(value.value) : 0) + by[axis]);
    }
  });
}

/** The middle of where an object may be, along the axes its place is written in. */
export function place(tree: Document, item: Keys): [number, number, number] {
  const at = tree.getIn([...item, 'at'], true);
  const one = (letter: string, axis: number) => {
    const value = tree.getIn([...item, 'at', isMap(at) ? letter : axis], true);
    if (isSeq(value)) return (Number(value.get(0)) + Number(value.get(1))) / 2;
    return isScalar(value) ? Number(value.value) : 0;
  };
  return at === undefined ? [0, 0, 0] : [one('x', 0), one('y', 1), one('z', 2)];
}

/** Gives an object another name, in the scene and in the script. */
export function renameItem(document: TaskDocument, item: ItemView, to: string): string {
  const at = keys(item.path);
  document.edit((tree) => {
    const scene = tree.getIn(at.slice(0, -1)) as YAMLMap;
    const pair = scene.items.find((pair) => String((pair.key as { value?: unknown })?.value ?? pair.key) === at.at(-1));
    if (!pair) return;
    // In place: comments before it stay.
    if (isScalar(pair.key)) pair.key.value = to;
    else pair.key = tree.createNode(to);
    rename(tree, item.name, `${prefixOf(item.name)}${to}`);
  });
  return [...at.slice(0, -1), to].join('.');
}

/** Adds a step at the end of the script. */
export function addStep(document: TaskDocument, step: Value) {
  document.edit((tree) => addStepTo(tree, step));
}

/** Moves a step of the script. */
export function moveStep(document: TaskDocument, from: number, to: number) {
  document.edit((tree) => {
    const script = tree.get('script');
    if (!isSeq(script) || to < 0 || to >= script.items.length) return;
    const [step] = script.items.splice(from, 1);
    script.items.splice(to, 0, step);
  });
}

/** Takes a step out of the script. */
export function removeStep(document: TaskDocument, index: number) {
  document.edit((tree) => tree.deleteIn(['script', index]));
}

function addStepTo(tree: Document, step: Value) {
  const script = tree.get('script');
  const node = tree.createNode(step);
  // `dwell: {in: ball, for_s: 0.25}`, as in the files that come with the program.
  if (isMap(node)) node.items.forEach((pair) => isMap(pair.value) && (pair.value.flow = true));
  if (isSeq(script)) {
    // `[]` is written on one line; steps are not.
    script.flow = false;
    script.add(node);
  } else tree.set('script', tree.createNode([step]));
}

function sceneOf(tree: Document, at: Keys): YAMLMap {
  if (!isMap(tree.getIn(at))) tree.setIn(at, tree.createNode({}));
  const scene = tree.getIn(at) as YAMLMap;
  scene.flow = false;
  return scene;
}

function block(tree: Document, item: Value) {
  const node = tree.createNode(item);
  flow(node);
  return node;
}

function freeName(scene: YAMLMap, kind: string): string {
  const base = kind || 'object';
  if (!scene.has(base)) return base;
  for (let number = 2; ; number++) if (!scene.has(`${base}_${number}`)) return `${base}_${number}`;
}

/** A place beside what stands there already: each new object a little farther to the left. */
function freePlace(tree: Document, wish: number[]): number[] {
  const scene = tree.get('scene');
  if (!isMap(scene)) return wish;
  const taken = scene.items.map((pair) =>
    place(tree, ['scene', String((pair.key as { value?: unknown }).value ?? pair.key)]),
  );
  const steps = [0, 0.08, -0.08, 0.16, -0.16, 0.24, -0.24, 0.32];
  const isFree = (y: number) => taken.every((at) => Math.hypot(at[0] - wish[0], at[1] - y, at[2] - wish[2]) > 0.07);
  const [x, y, z] = wish;
  return [x, y + (steps.find((step) => isFree(y + step)) ?? 0), z];
}

function prefixOf(name: string): string {
  return name.includes('.') ? name.slice(0, name.lastIndexOf('.') + 1) : '';
}

/** Replaces a name in everything that a script says, also where it says only the end of it. */
function rename(tree: Document, from: string, to: string) {
  const own = ends(tree, from);
  eachName(tree, (name) => {
    const said = own.find((end) => name === end || name.startsWith(`${end}.`));
    return said === undefined ? name : to + name.slice(said.length);
  });
}

/** A name and what is left of it without the groups that it is in: a script may say any of these that is the end of one name only. */
function ends(tree: Document, name: string): string[] {
  const parts = name.split('.');
  const all = parts.map((_, index) => parts.slice(index));
  // What is a whole name of its own is no end of another.
  return all.filter((end, index) => index === 0 || !tree.hasIn(['scene', end[0]])).map((end) => end.join('.'));
}

/** Keys whose values are words and no names of objects. */
const NO_NAMES = ['type', 'kind', 'from'];

function eachName(tree: Document, change: (name: string) => string) {
  const visit = (node: unknown) => {
    if (isScalar(node) && typeof node.value === 'string') node.value = change(node.value);
    else if (isSeq(node)) node.items.forEach(visit);
    else if (isMap(node)) {
      node.items
        .filter((pair) => !NO_NAMES.includes(String(isScalar(pair.key) ? pair.key.value : pair.key)))
        .forEach((pair) => visit(pair.value));
    }
  };
  visit(tree.get('script'));
  visit(tree.get('technique'));
}

/** Takes objects out of the script: from lists, and steps that ask for nothing else. */
function forget(tree: Document, names: string[]) {
  const script = tree.get('script');
  if (!isSeq(script)) return;
  const gone = new Set(names.flatMap((name) => ends(tree, name)));
  const isGone = (node: unknown) => isScalar(node) && gone.has(String(node.value));
  const asks = (node: unknown): boolean => {
    if (isScalar(node)) return isGone(node);
    if (isSeq(node)) {
      node.items = node.items.filter((part) => !asks(part));
      return node.items.length === 0;
    }
    return isMap(node) && node.items.some((pair) => asks(pair.value));
  };
  script.items = script.items.filter((step) => !asks(step));
}
