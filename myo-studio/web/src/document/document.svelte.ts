import { Document, isCollection, isMap, isNode, isScalar, isSeq, parseDocument, type ParsedNode } from 'yaml';
import { keys, type Keys } from './path';

/** Lines are not broken, and flow lists look as people write them: `[0.3, 0, -0.1]`. */
const FORMAT = { lineWidth: 0, flowCollectionPadding: false } as const;
/** A micrometre: what a drag leaves behind in binary is not written. */
const DIGITS = 1e6;

export type Value = string | number | boolean | null | Value[] | { [key: string]: Value };

/**
 * The text of a task, and every text that it was since it was opened. The text is all there is: what is seen is made from it, and an
 * edit changes it in place, so that comments and the order of keys stay as people wrote them.
 */
export class TaskDocument {
  private static count = 0;
  /** Tells it from every other. */
  readonly id = (TaskDocument.count += 1);
  name = $state('');
  text = $state('');
  /** Counts changes, so that answers to old questions can be told from new ones. */
  version = $state(0);
  private past = $state.raw<string[]>([]);
  private future = $state.raw<string[]>([]);
  /** The text as a tree: many fields read it, and a drag changes it many times a second. */
  private read: { text: string; tree: Document } | undefined;
  /** The text before a drag began: all of it is one step back. */
  private before: string | undefined;

  constructor(name: string, text: string) {
    this.name = name;
    this.text = text;
  }

  get canUndo() {
    return this.past.length > 0;
  }

  get canRedo() {
    return this.future.length > 0;
  }

  undo() {
    const text = this.past.at(-1);
    if (text === undefined) return;
    this.past = this.past.slice(0, -1);
    this.future = [...this.future, this.text];
    this.show(text);
  }

  redo() {
    const text = this.future.at(-1);
    if (text === undefined) return;
    this.future = this.future.slice(0, -1);
    this.past = [...this.past, this.text];
    this.show(text);
  }

  /** What is changed until `end` is one step back. */
  begin() {
    this.before ??= this.text;
  }

  end() {
    const before = this.before;
    this.before = undefined;
    if (before !== undefined && before !== this.text) this.remember(before);
  }

  /** Puts another text in place. */
  replace(text: string) {
    if (text === this.text) return;
    if (this.before === undefined) this.remember(this.text);
    this.show(text);
  }

  /** Changes the text as a tree. */
  edit(change: (tree: Document) => void) {
    const tree = this.tree();
    // A text that is no YAML is changed by hand alone.
    if (tree.errors.length > 0) return;
    // A change that fails half-way leaves nothing behind.
    this.read = undefined;
    change(tree);
    const text = tree.toString(FORMAT);
    this.read = { text, tree };
    this.replace(text);
  }

  private tree(): Document {
    const { text } = this;
    if (this.read?.text !== text) this.read = { text, tree: parseDocument(text) as Document };
    return this.read.tree;
  }

  /** Writes a value, where one is or not. */
  set(path: string, value: Value) {
    this.edit((tree) => setIn(tree, keys(path), value));
  }

  /** Takes a value out: its default counts again. */
  unset(path: string) {
    this.edit((tree) => tree.deleteIn(keys(path)));
  }

  /** What stands at a path; undefined where nothing does. */
  get(path: string): Value | undefined {
    const tree = this.tree();
    const node = path ? tree.getIn(keys(path), true) : tree.contents;
    return isNode(node) ? (node.toJS(tree) as Value) : undefined;
  }

  private remember(text: string) {
    this.past = [...this.past, text];
    this.future = [];
  }

  private show(text: string) {
    this.text = text;
    this.version += 1;
  }
}

/** Writes a value into a tree: numbers into the numbers that stand there, so that comments beside them stay. */
export function setIn(tree: Document, at: Keys, value: Value) {
  const node = tree.getIn(at, true);
  if (isScalar(node) && !isObject(value)) {
    node.value = rounded(value);
    // How it was written is for what it was.
    delete node.format;
    delete node.source;
  } else if (isSeq(node) && Array.isArray(value) && node.items.length === value.length) {
    value.forEach((part, index) => setIn(tree, [...at, index], part));
  } else if (isMap(node) && isObject(value) && !Array.isArray(value)) {
    const gone = node.items.map((pair) => String(pair.key)).filter((key) => !(key in value));
    gone.forEach((key) => node.delete(key));
    Object.entries(value).forEach(([key, part]) => setIn(tree, [...at, key], part));
  } else {
    const made = tree.createNode(rounded(value));
    flow(made as ParsedNode);
    if (isNode(node) && node.comment) made.comment = node.comment;
    tree.setIn(at, made);
  }
}

/** Lists of numbers stand on one line, as they do in the files that come with the program. */
export function flow(node: unknown) {
  if (isSeq(node) && node.items.every((item) => isScalar(item) || (isSeq(item) && item.items.every(isScalar)))) {
    node.flow = true;
  }
  if (isCollection(node)) {
    node.items.forEach((item) => flow((item as { value?: unknown }).value ?? item));
  }
}

function isObject(value: Value): value is Value[] | { [key: string]: Value } {
  return typeof value === 'object' && value !== null;
}

function rounded(value: Value): Value {
  // A zero that came from below is written as any other.
  if (typeof value === 'number') return Math.round(value * DIGITS) / DIGITS || 0;
  if (Array.isArray(value)) return value.map(rounded);
  if (isObject(value)) return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, rounded(part)]));
  return value;
}
