import { isMap, isScalar, isSeq, type Document } from 'yaml';
import type { ItemView } from '../engine/protocol';
import type { Change } from '../view/manipulate';
import { setIn } from './document.svelte';
import { keys, type Keys } from './path';
import { moveBy } from './scene';

/** Least size that a drag makes (m). */
const LEAST_M = 0.002;

/** Carries out in the text what a drag asks for. */
export function changeItem(tree: Document, item: ItemView, change: Change) {
  const at = keys(item.path);
  // What is shown may be older than the text.
  if (!tree.hasIn(at)) return;
  if (change.way) moveBy(tree, at, written(item, change.way));
  if (item.kind !== 'sphere') {
    if (change.tilt_deg !== undefined) setAngle(tree, [...at, 'tilt_deg'], change.tilt_deg);
    if (change.turn_deg !== undefined) setAngle(tree, [...at, 'turn_deg'], change.turn_deg);
  }
  if (change.size) resize(tree, item.kind, at, change.size);
}

/** A way in the world (m) along the axes and in the scale in which the place of an item is written. */
function written({ parent_rotation: [x, y, z, w], parent_scale }: ItemView, way: [number, number, number]) {
  // Turned back by the quaternion: `v + 2 q × (q × v + w v)` with its vector part negated.
  const q = [-x, -y, -z] as const;
  const half = sum(cross(q, way), times3(way, w));
  return times3(sum(way, times3(cross(q, half), 2)), 1 / parent_scale);
}

type Triple = readonly [number, number, number];

const sum = (a: Triple, b: Triple): Triple => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

const times3 = (a: Triple, factor: number): [number, number, number] => [a[0] * factor, a[1] * factor, a[2] * factor];

const cross = (a: Triple, b: Triple): Triple => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** Zero is what counts where nothing is written. */
function setAngle(tree: Document, at: Keys, degrees: number) {
  if (degrees !== 0 || tree.hasIn(at)) setIn(tree, at, degrees);
}

/** Factors are along own axes: up the face, across it, out of it. Sizes are written as width, height, depth. */
function resize(tree: Document, kind: string, at: Keys, [up, across, out]: [number, number, number]) {
  const most = [up, across, out].reduce(
    (most, factor) => (Math.abs(factor - 1) > Math.abs(most - 1) ? factor : most),
    1,
  );
  switch (kind) {
    case 'sphere':
      return times(tree, [...at, 'radius'], most);
    case 'button':
    case 'obstacle':
      [across, up, out].forEach((factor, index) => times(tree, [...at, 'size', index], factor));
      return;
    case 'slider': {
      const [along, aside] = tree.getIn([...at, 'rises']) === 'up' ? [up, across] : [across, up];
      times(tree, [...at, 'length'], along);
      if (tree.hasIn([...at, 'width'])) times(tree, [...at, 'width'], aside);
      return;
    }
    case 'stick':
      return times(tree, [...at, 'length'], most);
    case 'group': {
      const scale = tree.getIn([...at, 'scale']);
      return setIn(tree, [...at, 'scale'], Math.max(0.05, Number(scale ?? 1) * most));
    }
    case 'grid': {
      const pitch = tree.getIn([...at, 'pitch'], true);
      if (isSeq(pitch)) [across, up].forEach((factor, index) => times(tree, [...at, 'pitch', index], factor));
      else times(tree, [...at, 'pitch'], most);
      return;
    }
    case 'arc':
      return times(tree, [...at, 'radius'], most);
    case 'circle':
      return times(tree, [...at, 'diameter'], most);
    case 'keyboard':
      times(tree, [...at, 'pitch'], most);
      return times(tree, [...at, 'key'], most);
  }
}

/** A length, or both ends of a range of lengths, times a factor. */
function times(tree: Document, at: Keys, factor: number) {
  const node = tree.getIn(at, true);
  if (isScalar(node)) setIn(tree, at, Math.max(LEAST_M, Number(node.value) * factor));
  else if (isSeq(node)) node.items.forEach((_, index) => times(tree, [...at, index], factor));
  else if (isMap(node)) node.items.forEach((pair) => times(tree, [...at, String(pair.key)], factor));
}
