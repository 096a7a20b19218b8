// Both sides' settings: defaults from the renderer, changes by the page, and the link that holds them.
// In a link, `left.` and `right.` stand before the settings that are not the default, or that the technique changes.

const SIDES = { reference: 'left', chosen: 'right' };

export class Settings {
  /** `defaults`: the renderer's; `table`: what is to be known of each setting. */
  constructor(defaults, table) {
    this.defaults = defaults;
    this.table = table;
    this.use({});
  }

  entry(key) {
    return this.table.find((entry) => entry.key === key);
  }

  use(technique) {
    this.technique = technique;
    this.sides = {
      reference: { ...this.defaults, ...technique.reference },
      chosen: { ...this.defaults, ...technique.chosen },
    };
  }

  set(side, key, value) {
    this.sides[side][key] = value;
  }

  changed(side, key) {
    return JSON.stringify(this.sides[side][key]) !== JSON.stringify(this.defaults[key]);
  }

  /** Adds what is not the default, and what the technique changes, to a link's parameters. */
  write(link) {
    for (const [side, short] of Object.entries(SIDES)) {
      for (const { key } of this.table) {
        const isOfTechnique = this.technique[side]?.[key] !== undefined;
        if (isOfTechnique || this.changed(side, key)) link.set(`${short}.${key}`, String(this.sides[side][key]));
      }
    }
  }

  /** Takes over a link's names and words of settings; tells which it could not read. */
  read(words) {
    const unread = [];
    for (const [name, text] of words) {
      const [short, key] = name.split('.', 2);
      const side = Object.keys(SIDES).find((s) => SIDES[s] === short);
      const entry = side && this.entry(key);
      const value = entry && parse(entry, text);
      if (value === undefined) unread.push(`${name}=${text}`);
      else this.set(side, key, value);
    }
    return unread;
  }
}

function parse(entry, text) {
  switch (entry.kind) {
    case 'switch':
      return text === 'true' ? true : text === 'false' ? false : undefined;
    case 'choice':
      return entry.names.includes(text) ? text : undefined;
    case 'integer':
      return /^-?\d+$/.test(text) && text >= entry.least && text <= entry.most ? Number(text) : undefined;
    case 'number':
      return text !== '' && Number.isFinite(Number(text)) ? Number(text) : undefined;
    case 'place': {
      const place = text.split(',').map(Number);
      return place.length === 2 && place.every(Number.isFinite) ? place : undefined;
    }
    case 'text':
      return text;
    default:
      return undefined;
  }
}
