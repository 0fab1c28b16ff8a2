import { Refused, type Connection, type Engine, type Motion } from '../engine/engine';
import type {
  Finding,
  ItemView,
  Job,
  JobOrder,
  PresetCard,
  RewardMap,
  RunEntry,
  Step,
  Surface,
  TaskFile,
  TaskView,
  Welcome,
} from '../engine/protocol';
import { TaskDocument } from '../document/document.svelte';
import { isWithin, path } from '../document/path';
import type { Change } from '../view/manipulate';
import { changeItem } from '../document/change';
import type { Schema } from '../schema/schema';

export type Page =
  | { at: 'home' }
  | { at: 'setup' }
  | { at: 'runs' }
  | { at: 'run'; name: string }
  | { at: 'compare'; names: string[] }
  | { at: 'whatif' };

/** A file is written so long after the last change. */
const SAVE_AFTER_MS = 400;

/** A live training goes on so long after the last change: not at every step of a drag. */
const RELEARN_AFTER_MS = 250;

const EMPTY = (name: string) => `version: 2
name: ${name}
description: ''
scene: {}
script: []
time_limit_s: 5
`;

/** Everything that the page knows and shows. */
export class Studio {
  connection = $state<Connection>('connecting');
  welcome = $state.raw<Welcome>();
  schema = $state.raw<Schema>();
  page = $state<Page>({ at: 'home' });
  jobs = $state.raw<Job[]>([]);
  runs = $state.raw<RunEntry[]>([]);
  tasks = $state.raw<TaskFile[]>([]);
  document = $state.raw<TaskDocument>();
  /** What the text says; the last that could be read, so that one slip does not empty the scene. */
  view = $state.raw<TaskView>();
  /** What is wrong in the text as it stands, and what the body says to it. */
  private plain = $state.raw<Finding[]>([]);
  private checked = $state.raw<Finding[]>([]);
  pose = $state.raw<Motion>();
  surface = $state.raw<Surface>();
  showsReach = $state(false);
  selection = $state.raw<string[]>([]);
  saved = $state<'saved' | 'saving' | 'unsaved'>('saved');
  /** One sentence about what went wrong last. */
  notice = $state<string>();
  advanced = $state(false);
  theme = $state<'light' | 'dark'>(preferred());
  /** The training whose movement is shown. */
  watched = $state<number>();
  seesMotion: ((motion: Motion) => void) | undefined;

  /** When the text was changed last (ms since the page came). */
  touched = 0;
  /** Names of the tasks that are held against each other, the first as what the others are measured by. */
  whatIf = $state.raw<string[]>([]);
  /** What distance costs in space, where it is shown. */
  rewardMap = $state.raw<RewardMap>();
  /** Settings of the learner that are not as they come. */
  learner = $state.raw<Record<string, unknown>>({});
  /** When a training ends: `plateau`, or a share of success. */
  until = $state('plateau');
  /** Whether the user goes on learning whenever the task is changed. */
  live = $state(false);
  private relearning: ReturnType<typeof setTimeout> | undefined;
  private saving: ReturnType<typeof setTimeout> | undefined;
  private looking = false;
  private checking = false;
  private posed = '';

  constructor(readonly engine: Engine) {
    engine.onConnection((connection) => {
      this.connection = connection;
      if (connection === 'open') void this.arrive();
    });
    engine.onEvent((event) => {
      if (event.event === 'jobs') this.hearJobs(event.jobs);
      if (event.event === 'runs') void this.listRuns();
      if (event.event === 'tasks') void this.hearTask(event.name);
    });
    engine.onMotion((motion) => this.seesMotion?.(motion));
  }

  get findings(): Finding[] {
    return this.plain.length > 0 ? this.plain : this.checked;
  }

  get errors(): Finding[] {
    return this.findings.filter((finding) => finding.severity === 'error');
  }

  /** What is selected, as long as it is there. */
  get selected(): ItemView[] {
    return this.selection.flatMap((path) => this.view?.items.find((item) => item.path === path) ?? []);
  }

  /** What an object is written as: the innermost item that it belongs to. */
  itemOf(object: number): ItemView | undefined {
    const { view } = this;
    return view?.items.findLast((item) => item.objects.includes(object));
  }

  findingsAt(path: string): Finding[] {
    return this.findings.filter((finding) => finding.path !== null && isWithin(finding.path, path));
  }

  private async arrive() {
    await this.try(async () => {
      const [welcome, schema] = await Promise.all([this.engine.ask('hello', {}), this.engine.ask('schema', {})]);
      this.welcome = welcome;
      this.schema = schema as Schema;
      this.tasks = await this.engine.ask('tasks', {});
      await this.listRuns();
      if (this.saved === 'unsaved') await this.save();
      if (this.watched !== undefined) await this.engine.ask('watch', { job: this.watched });
    });
  }

  /** Does something, and says in one sentence why it could not be done. */
  async try<T>(act: () => Promise<T>): Promise<T | undefined> {
    try {
      return await act();
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      this.notice = error.message;
      return undefined;
    }
  }

  private hearJobs(jobs: Job[]) {
    const isNew = (job: Job) => !this.jobs.some((other) => other.id === job.id);
    const begun = jobs.filter((job) => isNew(job) && this.jobs.length > 0);
    this.jobs = jobs;
    const running = jobs.find((job) => ['training', 'preparing', 'paused', 'evaluating'].includes(job.state.is));
    if (begun.length > 0 && running) this.watch(running.id);
    else if (running && this.watched === undefined) this.watch(running.id);
  }

  watch(job: number | undefined) {
    if (this.watched === job) return;
    this.watched = job;
    void this.try(() => this.engine.ask('watch', { job: job ?? null }));
  }

  async listRuns() {
    this.runs = (await this.try(() => this.engine.ask('runs', {}))) ?? this.runs;
  }

  private async hearTask(name: string | null) {
    this.tasks = (await this.try(() => this.engine.ask('tasks', {}))) ?? this.tasks;
    const { document } = this;
    if (!document || name !== document.name || this.saved !== 'saved') return;
    const { version } = document;
    const opened = await this.try(() => this.engine.ask('open', { name }));
    // Another page has changed what is open here, and nobody has changed it here meanwhile.
    const isCurrent = document === this.document && document.version === version && this.saved === 'saved';
    if (!opened || opened.text === document.text || !isCurrent) return;
    document.replace(opened.text);
    void this.see();
  }

  /** A name that no task has yet. */
  freeName(base: string): string {
    const taken = new Set(this.tasks.map((task) => task.name));
    if (!taken.has(base)) return base;
    for (let number = 2; ; number++) if (!taken.has(`${base}-${number}`)) return `${base}-${number}`;
  }

  begin(preset?: PresetCard) {
    const name = this.freeName(preset?.name ?? 'my-task');
    const text = preset ? preset.text.replace(/^name: .*$/m, `name: ${name}`) : EMPTY(name);
    // Whoever only looks leaves no file behind: it is kept from the first change on.
    this.show(new TaskDocument(name, text));
  }

  async open(name: string) {
    const opened = await this.try(() => this.engine.ask('open', { name }));
    if (opened) this.show(new TaskDocument(opened.name, opened.text));
  }

  /** A copy of a task, to be changed: it is kept from the beginning, and held against what it comes from. */
  openCopy(name: string, text: string) {
    const copy = this.freeName(name === this.freeName(name) ? `${name}-variant` : name);
    this.show(new TaskDocument(copy, text.replace(/^name: .*$/m, `name: ${copy}`)));
    this.touch();
    this.whatIf = [...new Set([...this.whatIf, name, copy])];
  }

  async import(file: File) {
    const name = this.freeName(file.name.replace(/\.ya?ml$/i, '') || 'imported');
    this.show(new TaskDocument(name, await file.text()));
    this.touch();
  }

  private show(document: TaskDocument) {
    // What was changed a moment ago is kept before something else is opened.
    if (this.saved === 'unsaved') void this.save();
    this.document = document;
    this.saved = 'saved';
    this.view = undefined;
    this.plain = [];
    this.checked = [];
    this.selection = [];
    this.posed = '';
    this.page = { at: 'setup' };
    void this.see();
  }

  /** The text was changed: it is looked at anew, and kept. */
  touch() {
    this.saved = 'unsaved';
    this.touched = performance.now();
    clearTimeout(this.saving);
    if (this.live) {
      clearTimeout(this.relearning);
      this.relearning = setTimeout(() => void this.relearn(), RELEARN_AFTER_MS);
    }
    this.saving = setTimeout(() => void this.save(), SAVE_AFTER_MS);
    void this.see();
  }

  async save() {
    const { document } = this;
    if (!document) return;
    clearTimeout(this.saving);
    this.saved = 'saving';
    const { version, name, text } = document;
    const done = await this.try(() => this.engine.ask('save', { name, text }));
    this.saved = done && document.version === version ? 'saved' : 'unsaved';
  }

  /** Which text of which document it is. */
  private get mark(): string {
    return `${this.document?.id} ${this.document?.version}`;
  }

  /** Asks what the text says; of many changes in a row the last counts. */
  async see() {
    if (this.looking) return;
    this.looking = true;
    let seen: unknown;
    while (this.document && seen !== this.mark) {
      const { document } = this;
      seen = this.mark;
      const look = await this.try(() => this.engine.ask('look', { text: document.text }));
      if (!look || document !== this.document) continue;
      this.plain = look.findings;
      if (look.view) this.view = look.view;
    }
    this.looking = false;
    void this.check();
    void this.stand();
  }

  /** Waits until the view is that of the text. */
  async settled() {
    while (this.looking) await new Promise((resolve) => setTimeout(resolve, 5));
  }

  /** Asks what the body says to it: that takes longer. */
  private async check() {
    if (this.checking) return;
    this.checking = true;
    let seen: unknown;
    while (this.document && seen !== this.mark) {
      const { document } = this;
      seen = this.mark;
      if (this.plain.some((finding) => finding.severity === 'error')) {
        this.checked = [];
        continue;
      }
      const found = await this.try(() => this.engine.ask('check', { text: document.text }));
      if (found && document === this.document) this.checked = found;
    }
    this.checking = false;
  }

  /** The user at the beginning: asked anew where another body or another beginning is meant. */
  private async stand() {
    const { document, view } = this;
    if (!document || !view) return;
    const key = `${document.name} ${view.model} ${JSON.stringify(document.get('reset') ?? null)}`;
    if (key === this.posed) return;
    this.posed = key;
    try {
      this.pose = await this.engine.pose({ text: document.text });
    } catch (error) {
      // A task that is not right yet has no user; the one of before stays.
      if (!(error instanceof Refused)) throw error;
      this.posed = '';
    }
    if (!this.pose) this.pose = await this.try(() => this.engine.pose({ text: this.welcome?.presets[0]?.text ?? '' }));
  }

  /** Writes a task of version 1 anew, as one step that can be taken back. */
  async convert() {
    const { document } = this;
    if (!document) return;
    const text = await this.try(() => this.engine.ask('convert', { text: document.text }));
    if (text === undefined) return;
    document.replace(text);
    this.touch();
  }

  async toggleReach() {
    this.showsReach = !this.showsReach;
    const { document } = this;
    if (this.showsReach && document) {
      this.surface = await this.try(() => this.engine.ask('reach', { text: document.text }));
    }
  }

  select(paths: string[]) {
    this.selection = paths;
  }

  pick(object: number | undefined, add: boolean) {
    const item = object === undefined ? undefined : this.itemOf(object);
    if (!item) {
      if (!add) this.selection = [];
    } else if (!add) {
      // Who takes hold of one of several takes all of them.
      if (!this.selection.includes(item.path)) this.selection = [item.path];
    } else if (this.selection.includes(item.path)) this.selection = this.selection.filter((path) => path !== item.path);
    else this.selection = [...this.selection, item.path];
  }

  /** Carries a drag out in the text: with all that is selected, where what is dragged is among it. */
  change(item: ItemView, change: Change) {
    const { document } = this;
    if (!document) return;
    const all = change.way && this.selection.includes(item.path) ? this.selected : [item];
    document.edit((tree) => all.forEach((one) => changeItem(tree, one, change)));
    this.touch();
  }

  /** Edits the text by a function of the document. */
  edit<T>(act: (document: TaskDocument) => T): T | undefined {
    const { document } = this;
    if (!document) return undefined;
    const done = act(document);
    this.touch();
    return done;
  }

  set(at: (string | number)[], value: Parameters<TaskDocument['set']>[1] | undefined) {
    this.edit((document) => (value === undefined ? document.unset(path(at)) : document.set(path(at), value)));
  }

  async train(order: Partial<JobOrder> = {}) {
    const { document } = this;
    if (!document) return;
    await this.save();
    const whole: JobOrder = {
      text: document.text,
      name: document.name,
      seed: 1,
      users: 1,
      until: this.until,
      steps: null,
      from: null,
      live: this.live,
      settings: this.learner,
      ...order,
    };
    const ids = await this.try(() => this.engine.ask('train', { order: whole }));
    if (ids?.length) this.watch(ids[0]);
  }

  /** The training that follows the open task, if there is one. */
  get liveJob(): Job | undefined {
    return this.jobs.findLast((job) => job.live && job.title === this.document?.name);
  }

  async setLive(on: boolean) {
    this.live = on;
    if (!on) return;
    // A user that has learnt this task already goes on from there.
    const known = this.jobs.findLast(
      (job) => job.title === this.document?.name && job.run && !job.live && job.state.is === 'done',
    );
    if (this.liveJob) await this.relearn();
    else await this.train({ live: true, from: known?.run ?? null });
  }

  /** Lets the user go on with the task as it is now. */
  private async relearn() {
    const { document } = this;
    // The checks of a change come first: what cannot be trained is said at its field.
    await this.settled();
    while (this.checking) await new Promise((resolve) => setTimeout(resolve, 10));
    if (!document || document !== this.document || this.errors.length > 0) return;
    const job = this.liveJob;
    if (job) await this.try(() => this.engine.ask('relearn', { job: job.id, text: document.text, settings: null }));
    else await this.train({ live: true });
  }

  /** Lets a user go on with the task and the settings of the learner as they are now. */
  async goOnWithThis(job: number) {
    const { document } = this;
    if (!document) return;
    await this.save();
    // Where nothing was changed here, the learner stays as it is.
    const settings = Object.keys(this.learner).length > 0 ? this.learner : null;
    await this.try(() => this.engine.ask('relearn', { job, text: document.text, settings }));
  }

  tell(job: number, step: Step) {
    return this.try(() => this.engine.ask('tell', { job, step }));
  }

  setTheme(theme: 'light' | 'dark') {
    this.theme = theme;
    localStorage.setItem('myo-theme', theme);
  }
}

function preferred(): 'light' | 'dark' {
  const kept = localStorage.getItem('myo-theme');
  if (kept === 'light' || kept === 'dark') return kept;
  return matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}
