// Controls for settings, made from the renderer's own table of them.

/** One control. `changed(value)` is called when the user changes it. */
export function control(entry, value, prefix, changed) {
  const row = document.createElement('div');
  row.className = 'setting';
  const label = document.createElement('label');
  label.textContent = entry.label;
  label.title = entry.help;
  label.htmlFor = `${prefix}-${entry.key}`;
  const box = document.createElement('div');
  box.className = 'value';
  const input = makers[entry.kind](entry, value, changed, box);
  input.id = label.htmlFor;
  input.title = entry.help;
  row.append(label, box);
  return row;
}

const makers = {
  switch(entry, value, changed, box) {
    const input = element('input', { type: 'checkbox', checked: value });
    input.addEventListener('change', () => changed(input.checked));
    box.append(input);
    return input;
  },
  choice(entry, value, changed, box) {
    const input = document.createElement('select');
    for (const name of entry.names) input.add(new Option(name, name, false, name === value));
    input.addEventListener('change', () => changed(input.value));
    box.append(input);
    return input;
  },
  integer: (entry, value, changed, box) => range(entry, value, 1, changed, box),
  number: (entry, value, changed, box) => range(entry, value, 'any', changed, box),
  place(entry, value, changed, box) {
    const input = element('input', { type: 'text', value: value.join(', '), size: 9 });
    input.addEventListener('change', () => {
      const place = input.value.split(',').map(Number);
      const valid = place.length === 2 && place.every(Number.isFinite);
      input.setCustomValidity(valid ? '' : 'two numbers: 0.5, 0.5');
      input.reportValidity();
      if (valid) changed(place);
    });
    box.append(input);
    return input;
  },
  text(entry, value, changed, box) {
    const input = element('input', { type: 'text', value, size: 14 });
    input.addEventListener('change', () => changed(input.value));
    box.append(input);
    return input;
  },
};

function range(entry, value, step, changed, box) {
  const input = element('input', { type: 'range', min: entry.least, max: entry.most, step, value });
  const output = element('output', { value: short(value) });
  input.addEventListener('input', () => {
    output.value = short(Number(input.value));
    changed(Number(input.value));
  });
  box.append(input, output);
  return input;
}

const short = (value) => String(Math.round(value * 1000) / 1000);

const element = (name, properties) => Object.assign(document.createElement(name), properties);

/** All settings of one side, by stage; those that a page cannot honour are left out. */
export function fillPanel(place, settings, side, changed) {
  const open = new Set([...place.querySelectorAll('details[open]')].map((d) => d.dataset.stage));
  place.replaceChildren();
  const stages = new Map();
  for (const entry of settings.table) {
    if (!makers[entry.kind] || entry.key === 'width' || entry.key === 'height') continue;
    if (!stages.has(entry.stage)) {
      const details = element('details', { open: open.has(entry.stage) });
      details.dataset.stage = entry.stage;
      details.append(element('summary', { textContent: entry.stage }));
      stages.set(entry.stage, details);
      place.append(details);
    }
    const row = control(entry, settings.sides[side][entry.key], side, (value) => {
      changed(side, entry.key, value);
      row.classList.toggle('changed', settings.changed(side, entry.key));
    });
    row.classList.toggle('changed', settings.changed(side, entry.key));
    stages.get(entry.stage).append(row);
  }
}
