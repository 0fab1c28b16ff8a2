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
  if (change.by) moveBy(tree, at, change.by);
  if (item.kind !== 'sphere') {
    if (change.tilt_deg !== undefined) setAngle(tree, [...at, 'tilt_deg'], change.tilt_deg);
    if (change.turn_deg !== undefined) setAngle(tree, [...at, 'turn_deg'], change.turn_deg);
  }
  if (change.size) resize(tree, item.kind, at, change.size);
}

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
    case 'slider':
      times(tree, [...at, 'length'], across);
      if (tree.hasIn([...at, 'width'])) times(tree, [...at, 'width'], up);
      return;
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
