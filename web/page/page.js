// What a frame hangs on, and how the page speaks.

import { Resolution } from './resolution.js';
import { TECHNIQUES } from './techniques.js';

export const $ = (id) => document.getElementById(id);

/** Everything that a frame hangs on. */
export const page = {
  viewer: null,
  // Why the device is gone, and whom to tell.
  lost: null,
  fail: null,
  settings: null,
  // The reduced renderer draws, with WebGL 2; on purpose: the link asked for it.
  reduced: false,
  reducedOnPurpose: false,
  // Those that can be drawn, and the one in use.
  techniques: TECHNIQUES,
  technique: TECHNIQUES[0],
  camera: null,
  split: 0.5,
  scale: 'auto',
  resolution: new Resolution(),
  always: false,
  gaze: true,
  // What is shown: a generated scene's name, or a dropped file's name and bytes, with those of files beside it by name.
  scene: { name: 'demo', bytes: null },
  home: null,
  // What the address asked for, its scene and the camera's place in it: shown first.
  asked: null,
  stale: true,
  // The viewer has not heard of the settings' last change.
  unapplied: true,
  // Frames still to be drawn until what adapts from frame to frame has come to rest.
  unsettled: 0,
  // The camera moved since the link was written.
  moved: false,
  busy: false,
  frames: 0,
  // Milliseconds from the page's opening to its first frame.
  firstFrameMs: null,
  // Of the WebAssembly, and how often it was loaded: anew after it stopped.
  memory: null,
  loads: 0,
  // The scene that was shown when it stopped last.
  stoppedAt: null,
  // What each side cost when it was drawn last, `together` in one frame; how they compare is `found`.
  costs: {},
  // What the last frame cost, of each side that it drew.
  drawn: {},
  // Whether more frames can tell nothing more of the two sides.
  measured: false,
};

/** No figures are left of a scene that is shown no more. */
export function forgetCosts() {
  page.costs = {};
  page.drawn = {};
}

export function redraw() {
  page.stale = true;
}

/** Text of files as it may be shown: control characters, and those that turn the direction of writing, escaped. */
export function printable(text) {
  return text.replace(/[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]/g, (c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, '0')}`);
}

export function say(text) {
  const message = document.createElement('div');
  message.className = 'message';
  const words = document.createElement('span');
  words.textContent = printable(text.replace(/\s+/g, ' '));
  const close = document.createElement('button');
  close.type = 'button';
  close.textContent = 'Close';
  close.addEventListener('click', () => message.remove());
  message.append(words, close);
  $('messages').replaceChildren(message);
}

export function wait(text) {
  $('wait').textContent = text ?? '';
  $('wait').hidden = !text;
}

/** Runs `work` alone: the viewer does one thing at a time. */
export async function alone(work) {
  while (page.busy) await new Promise((done) => setTimeout(done, 10));
  page.busy = true;
  try {
    return await work();
  } finally {
    page.busy = false;
  }
}
