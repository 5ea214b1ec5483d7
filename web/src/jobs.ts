// Commands that the page starts: their progress, their output, and what they made.
import { type FileList, json, post, query } from './api';
import type { App } from './context';
import type { Change } from './labelled';
import type { Menu } from './menu';
import { button, el, root } from './panel';

interface Job {
  number: number;
  verb: string;
  command: string;
  state: 'running' | 'done' | 'failed' | 'cancelled';
  exit_code: number;
  seconds: number;
  progress: string;
}

const POLL_MS = 300;

export class JobsPanel {
  /** Called after files were added. */
  readonly onFiles: (() => void)[] = [];
  private readonly list = el('ul', { class: 'jobs', 'aria-label': 'Commands' });
  private readonly watched = new Map<number, (job: Job) => void>();
  private timer = 0;
  private readonly named = new Set<string>();

  constructor(
    private readonly app: App,
    private readonly menu: Menu,
  ) {
    app.section('Commands', this.list);
    app.run(this.refresh());
  }

  /** A name that no file has yet, and that this page has not named before. */
  freshName(stem: string, extension = ''): string {
    const taken = new Set(this.app.files.list.map((f) => f.name));
    const stamp = Math.floor(Date.now() / 1000).toString(36);
    for (let k = 1; ; ++k) {
      const name = `${stem.replace(/[^A-Za-z0-9_-]/g, '_').slice(0, 40)}-${stamp}${k > 1 ? `-${k}` : ''}${extension}`;
      if (taken.has(name) || this.named.has(name)) continue;
      this.named.add(name);
      return name;
    }
  }

  /** Starts a command and waits until it has ended; throws where it did not end well. */
  async run(verb: string, parameters: Change): Promise<void> {
    const started = await post<Job>('jobs/start', { verb, ...parameters });
    this.app.tell(started.command);
    const ended = new Promise<Job>((resolve) => this.watched.set(started.number, resolve));
    await this.refresh();
    const job = await ended;
    await this.newFiles();
    if (job.state !== 'done') throw new Error(`${verb}: ${job.state}${job.progress ? `: ${job.progress}` : ''}`);
  }

  /** Runs a command and shows what it made. */
  async runAndShow(verb: string, parameters: Change): Promise<number> {
    await this.run(verb, parameters);
    const made = this.app.files.list.find((f) => f.name === parameters.name);
    if (!made) throw new Error(`${verb}: its result is not there`);
    await this.menu.toggle(made, true);
    return made.id;
  }

  /** Lists files that are new. */
  async newFiles(): Promise<void> {
    const { files } = await json<FileList>('files');
    for (const file of files.slice(this.app.files.list.length)) {
      this.app.files.list.push(file);
      this.menu.addFile(file);
    }
    this.onFiles.forEach((act) => act());
  }

  private async refresh(): Promise<void> {
    clearTimeout(this.timer);
    const { jobs } = await json<{ jobs: Job[] }>('jobs');
    this.list.replaceChildren(...jobs.slice(-20).reverse().map((job) => this.row(job)));
    root.dataset.jobs = jobs.map((j) => `${j.verb} ${j.state}`).join(', ');
    for (const job of jobs) {
      if (job.state === 'running') continue;
      this.watched.get(job.number)?.(job);
      this.watched.delete(job.number);
    }
    if (jobs.some((j) => j.state === 'running')) this.timer = window.setTimeout(() => this.app.run(this.refresh()), POLL_MS);
  }

  private row(job: Job): HTMLElement {
    const told = job.state === 'running' ? job.progress || 'running' : `${job.state}, ${job.seconds.toFixed(1)} s`;
    const output = button('Output', `Output of ${job.verb}`, () => this.app.run(this.showLog(job)));
    output.setAttribute('aria-label', `Output of ${job.verb}`);
    const cancel = button('Cancel', `Cancel ${job.verb}`, () =>
      this.app.run(post('jobs/cancel', { number: job.number }).then(() => this.refresh())),
    );
    return el(
      'li',
      {},
      el('code', {}, job.command),
      el('div', {}, told),
      output,
      ...(job.state === 'running' ? [cancel] : []),
    );
  }

  private async showLog(job: Job): Promise<void> {
    const { log, progress } = await json<Job & { log: string }>(`jobs/log?${query({ number: job.number })}`);
    const close = button('×', 'Close (Escape)', () => this.app.closeDetails());
    this.app.showDetails([
      el('div', { class: 'head' }, el('h2', {}, `Output of ${job.verb}`), close),
      el('pre', { class: 'log', tabindex: '0' }, `${log}${progress}`),
    ]);
  }
}
