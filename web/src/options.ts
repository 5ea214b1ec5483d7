// Forms of the options of commands, made from the program's own tables.
import { el } from './panel';

export interface Option {
  name: string;
  group: string;
  type: 'float' | 'int' | 'bool' | 'str' | 'Sequence[str]';
  default: string;
  unit: string;
  help: string;
  value: string;
  least: number | null;
  most: number | null;
  choices: string[];
}

/** A control of an option: `given` is its value, or '' for the default. */
interface Control {
  row: HTMLElement;
  given: () => string;
}

function control(option: Option): Control {
  const label = option.unit ? `${option.name}, ${option.unit}` : option.name;
  const row = (kind: string, ...parts: (HTMLElement | string)[]) => el('label', { class: `row ${kind}`, title: option.help }, ...parts);
  if (option.type === 'bool') {
    const box = el('input', { type: 'checkbox' });
    return { row: row('check', box, label), given: () => (box.checked ? 'true' : '') };
  }
  if (option.choices.length > 0) {
    const words = option.choices.includes(option.default) ? option.choices : [option.default, ...option.choices];
    const box = el('select', { 'aria-label': label }, ...words.map((word) => el('option', { value: word }, word)));
    box.value = option.default;
    return { row: row('', label, box), given: () => (box.value === option.default ? '' : box.value) };
  }
  if (option.type === 'str' || option.type === 'Sequence[str]') {
    const box = el('input', { type: 'text', placeholder: option.value });
    return { row: row('', label, box), given: () => box.value.trim() };
  }
  const box = el('input', { type: 'number', placeholder: option.default, step: option.type === 'int' ? '1' : 'any' });
  if (option.least !== null) box.min = `${option.least}`;
  if (option.most !== null) box.max = `${option.most}`;
  return {
    row: row('', label, box),
    given: () => {
      if (!box.checkValidity()) throw new Error(`${option.name}: ${box.validationMessage}`);
      return box.value;
    },
  };
}

/** The options of one command, a group below each heading. */
export class OptionForm {
  readonly box: HTMLDetailsElement;
  private readonly controls = new Map<string, Control>();

  constructor(verb: string, options: Option[]) {
    this.box = el('details', {}, el('summary', {}, `Options of ${verb}`));
    const groups = new Map<string, HTMLElement>([['', this.box]]);
    for (const option of options) {
      if (!groups.has(option.group)) {
        const group = el('details', {}, el('summary', {}, option.group));
        groups.set(option.group, group);
        this.box.append(group);
      }
      const made = control(option);
      this.controls.set(option.name.replaceAll('-', '_'), made);
      groups.get(option.group)!.append(made.row);
    }
  }

  /** The options that are not left at their defaults, as parameters of the command. */
  given(): Record<string, string> {
    const all = [...this.controls].map(([key, { given }]) => [key, given()]);
    return Object.fromEntries(all.filter(([, value]) => value !== ''));
  }
}
