// Where nothing can be drawn: a sentence, and a picture of each technique.

import { $ } from './page.js';
import { TECHNIQUES } from './techniques.js';

export function showStills(cause) {
  for (const id of ['stage', 'panel']) $(id).hidden = true;
  $('without').hidden = false;
  $('missing').textContent = `This page draws with WebGPU, or less with WebGL 2; this browser offers neither: ${cause}. Chrome, Edge and Safari 26 or newer have both, and Firefox 141 or newer on Windows; on Linux Firefox has WebGL 2. What you would see:`;
  for (const { key, name, text } of TECHNIQUES) {
    const figure = document.createElement('figure');
    const picture = document.createElement('img');
    picture.src = `stills/${key}.jpg`;
    picture.alt = `${name}: reference on the left, chosen settings on the right`;
    const caption = document.createElement('figcaption');
    const head = document.createElement('b');
    head.textContent = `${name}. `;
    caption.append(head, text);
    figure.append(picture, caption);
    $('stills').append(figure);
  }
}
