// From labels to a result: each button starts one command of the program, or what prepares it.
import { type App } from './context';
import { json, post } from './api';
import type { JobsPanel } from './jobs';
import type { Labeller } from './labeller';
import type { Menu } from './menu';
import { type Option, OptionForm } from './options';
import { button, el } from './panel';

/** Lets a person choose a file of some kinds. */
class Chooser {
  readonly box = el('select');
  readonly row: HTMLElement;

  constructor(
    private readonly app: App,
    label: string,
    private readonly kinds: readonly ('log' | 'model' | 'primitives' | 'scene')[],
    /** What is shown for no file; without it, one must be chosen. */
    private readonly none = '',
  ) {
    this.row = el('label', { class: 'row' }, label, this.box);
    this.refresh();
  }

  refresh(): void {
    const kept = this.box.value;
    const files = this.kinds.flatMap((kind) => this.app.of(kind));
    this.box.replaceChildren(
      ...(this.none ? [el('option', { value: '' }, this.none)] : []),
      ...files.map((f) => el('option', { value: `${f.id}` }, f.name)),
    );
    if (files.some((f) => `${f.id}` === kept)) this.box.value = kept;
  }

  get id(): number {
    if (this.box.value === '') throw new Error(`There is no ${this.kinds.join(' or ')}`);
    return Number(this.box.value);
  }

  /** The chosen file, if any. */
  get chosen(): number | undefined {
    return this.box.value === '' ? undefined : Number(this.box.value);
  }

  set(id: number): void {
    this.refresh();
    this.box.value = `${id}`;
  }
}

export class Workflow {
  readonly log: Chooser;
  readonly model: Chooser;
  readonly set: Chooser;
  readonly world: Chooser;
  private readonly simulated: Chooser;
  /** The world that made the simulated log, and the log that the model was fitted to: for scores. */
  private readonly scored: Chooser;
  private readonly train: Chooser;
  private readonly labelFile = el('select', { 'aria-label': 'File of labels' });
  private readonly labelSet = el('select', { 'aria-label': 'Numbers of the file' }, el('option', { value: '' }, 'as the file says'));
  /** The options of commands, by command. */
  private readonly forms = new Map<string, OptionForm>();
  private readonly formBox = el('div');
  /** The annotation that was made last. */
  private annotation = '';

  constructor(
    private readonly app: App,
    private readonly labeller: Labeller,
    private readonly jobs: JobsPanel,
    private readonly menu: Menu,
  ) {
    this.log = new Chooser(app, 'Log', ['log']);
    this.model = new Chooser(app, 'Model', ['model']);
    this.set = new Chooser(app, 'Primitives', ['primitives']);
    this.world = new Chooser(app, 'World', ['scene', 'model']);
    this.simulated = new Chooser(app, 'Simulated', ['log']);
    this.scored = new Chooser(app, 'Model of the simulation', ['scene', 'model'], 'none');
    this.train = new Chooser(app, 'Training log', ['log'], 'none');
    this.labelFile.addEventListener('focus', () => app.run(this.listLabelFiles()));
    const step = (text: string, title: string, work: () => Promise<unknown>) => button(text, title, () => app.run(work()));
    app.section(
      'From labels to scans',
      ...[this.log, this.model, this.set, this.world, this.simulated].map((c) => c.row),
      el(
        'div',
        { class: 'buttons' },
        step('Propose', 'Let segment label what has no class yet', () => this.propose()),
        step('Carry on', 'Carry the labels of a scan to the next one', () => this.carry()),
        step('Labelled log', 'Write the log with its labels', () => this.writeLog()),
        step('.label file', 'Write labels in the numbers of SemanticKITTI', () => this.writeLabels()),
        step('Fit', 'Fit a model to the log', () => this.fit()),
        step('Extract', 'Cut primitives out of the model along the labelled log', () => this.extract()),
        step('Annotate', 'Write the objects of the labelled log as an annotation on the model', () => this.annotate()),
        step('Compose again', 'Compose a scene of that annotation with the chosen primitives', () => this.compose()),
        step('Simulate', 'Simulate the beams of the log in the world', () => this.simulate()),
        step('Score', 'Compare the simulated log with the log', () => this.score()),
      ),
      this.formBox,
      el('label', { class: 'row' }, 'Labels', this.labelFile),
      el('label', { class: 'row' }, 'in numbers of', this.labelSet),
      el('div', { class: 'buttons' }, step('Import', 'Take labels over from this file of the folder for labels', () => this.importLabels())),
    );
    jobs.onFiles.push(() => {
      [this.log, this.model, this.set, this.world, this.simulated, this.scored, this.train].forEach((c) => c.refresh());
      app.run(this.listLabelFiles());
      labeller.listLogs();
    });
    app.run(this.listLabelFiles());
    app.run(this.listOptions());
  }

  private async listOptions(): Promise<void> {
    for (const [verb, options] of Object.entries(await json<Record<string, Option[]>>('jobs/options'))) {
      this.forms.set(verb, new OptionForm(verb, options));
      const sets = options.find((option) => verb === 'segment' && option.name === 'label-set')?.choices ?? [];
      this.labelSet.append(...sets.map((set) => el('option', { value: set }, set)));
    }
    this.forms.get('score')?.box.append(this.scored.row, this.train.row);
    this.formBox.replaceChildren(...[...this.forms.values()].map((form) => form.box));
  }

  /** The options of a command that are not left at their defaults. */
  private given(verb: string): Record<string, string> {
    return this.forms.get(verb)?.given() ?? {};
  }

  /** Lists the files of the folder for labels that may be read. */
  private async listLabelFiles(): Promise<void> {
    const { names } = await json<{ names: string[] }>('labels/files');
    const kept = this.labelFile.value;
    this.labelFile.replaceChildren(...names.map((name) => el('option', { value: name }, name)));
    if (names.includes(kept)) this.labelFile.value = kept;
  }

  private async importLabels(): Promise<void> {
    const labelled = this.labelled();
    const [name, set] = [this.labelFile.value, this.labelSet.value];
    if (name === '') throw new Error('There is no file of labels in the folder for labels');
    const reply = await labelled.send<{ rows: number }>('import', { name, set, ...this.labeller.conditions() }, true);
    this.app.tell(`${reply.rows} points have other labels now, those of ${name}`);
  }

  private async annotate(): Promise<void> {
    const name = this.jobs.freshName(`${this.stem(this.log)}-site`, '.json');
    await this.jobs.run('annotate', { log: this.log.id, ground: this.model.id, name });
    this.annotation = name;
    this.app.tell(`Written: ${name}`);
  }

  private async compose(): Promise<void> {
    if (this.annotation === '') throw new Error('Annotate a labelled log first');
    const name = this.jobs.freshName('scene');
    const parameters = { ...this.given('compose'), annotation: this.annotation, primitives: this.set.id, ground: this.model.id, name };
    this.world.set(await this.jobs.runAndShow('compose', parameters));
  }

  private async score(): Promise<void> {
    const name = this.jobs.freshName(`${this.stem(this.simulated)}-score`, '.json');
    const files = { real: this.log.id, simulated: this.simulated.id, model: this.scored.chosen, train: this.train.chosen };
    await this.jobs.runAndShow('score', { ...this.given('score'), ...files, name });
  }

  showFile(id: number): Promise<void> {
    return this.menu.toggle(this.app.files.file(id), true);
  }

  private stem(chooser: Chooser): string {
    return this.app.files.file(chooser.id).name.replace(/\.[a-z]+$/, '').replace(/^.*\//, '');
  }

  private labelled() {
    const { labelled } = this.labeller;
    if (!labelled?.state) throw new Error('Choose a log to label first');
    return labelled;
  }

  async propose(): Promise<void> {
    const labelled = this.labelled();
    const stem = this.app.files.file(labelled.file).name.replace(/\.[a-z]+$/, '');
    const name = this.jobs.freshName(`${stem}-proposal`, '.ply');
    await this.jobs.run('segment', { ...this.given('segment'), log: labelled.file, name });
    const reply = await labelled.send<{ rows: number }>('import', { name, unlabelled: 1, ...this.labeller.conditions() }, true);
    this.app.tell(`${reply.rows} points have the label that segment proposes`);
  }

  async carry(): Promise<void> {
    const labelled = this.labelled();
    const scans = [...new Set(labelled.cloud!.octree.runs.map((run) => run.scan))];
    const asked = prompt(`Scan from which labels are carried to the next (${scans[0]} to ${scans.at(-2) ?? scans[0]})`, `${scans[0]}`);
    if (asked === null) return;
    const to = scans[scans.indexOf(Number(asked)) + 1];
    if (to === undefined) throw new Error('There is no scan after it');
    const reply = await labelled.send<{ rows: number }>('carry', { from_scan: Number(asked), scan: to, radius: 0.3 }, true);
    this.app.tell(`${reply.rows} points of scan ${to} have the label of the nearest point of scan ${asked}`);
  }

  async writeLog(): Promise<void> {
    const labelled = this.labelled();
    const stem = this.app.files.file(labelled.file).name.replace(/\.[a-z]+$/, '');
    const name = this.jobs.freshName(`${stem}-labelled`, '.ply');
    const reply = await post<{ path: string; file: number }>('labels/export', { file: labelled.file, format: 'log', name });
    await this.jobs.newFiles();
    this.log.set(reply.file);
    this.app.tell(`Written: ${reply.path}`);
  }

  async writeLabels(): Promise<void> {
    const labelled = this.labelled();
    const stem = this.app.files.file(labelled.file).name.replace(/\.[a-z]+$/, '');
    const name = this.jobs.freshName(stem, '.label');
    const reply = await post<{ path: string; without_number: number }>('labels/export', { file: labelled.file, format: 'label', name });
    const lost = reply.without_number ? `; ${reply.without_number} points have a class that the set does not know` : '';
    this.app.tell(`Written: ${reply.path}${lost}`);
  }

  async fit(): Promise<void> {
    const name = this.jobs.freshName(`${this.stem(this.log)}-model`);
    const log = this.log.id;
    this.model.set(await this.jobs.runAndShow('fit', { ...this.given('fit'), log, name }));
    this.train.set(log);
  }

  async extract(): Promise<void> {
    const name = this.jobs.freshName(`${this.stem(this.log)}-primitives`);
    this.set.set(await this.jobs.runAndShow('extract', { ...this.given('extract'), model: this.model.id, log: this.log.id, name }));
  }

  /** Simulates the beams of the log in the world, with the actors of a list of edits if one is named. */
  async simulate(actors?: string): Promise<void> {
    const name = this.jobs.freshName(`${this.stem(this.world)}-scan`, '.ply');
    const world = this.world.id;
    this.simulated.set(await this.jobs.runAndShow('simulate', { ...this.given('simulate'), world, like: this.log.id, actors, name }));
    if (actors === undefined) this.scored.set(world);
  }
}
