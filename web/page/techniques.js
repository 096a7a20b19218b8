// What the page offers at one touch. `reference` and `chosen` are changes to the default settings; `quick` are the
// settings shown beside it, those that are `shared` go to both sides. A `sum` is of the others. What is `reduced` needs no more than WebGL 2 has.
// `stills/` has a picture of each.

export const TECHNIQUES = [
  {
    key: 'coarse',
    name: 'Coarse shading',
    text: 'Each region is lit once per block of pixels, 1 to 256 wide: fine where you look, coarse around. Let the gaze follow the pointer. Where that costs more than it saves, it turns itself off; Force keeps it on.',
    chosen: { shading: 'coarse', display: 'fhd-24', quality: 9.3, 'force-rate': true },
    quick: ['view', 'composite', 'quality', 'force-rate'],
    gaze: true,
    views: ['final', 'rate', 'blocks', 'shaded'],
  },
  {
    key: 'msaa',
    name: 'Anti-aliasing',
    text: 'Pixels that several surfaces share are lit once per surface; all others once. Compare with every sub-sample lit (ssaa).',
    chosen: { aa: 'msaa' },
    quick: ['view', 'aa', 'samples'],
    views: ['final', 'edges', 'samples'],
  },
  {
    key: 'culling',
    name: 'Occlusion culling',
    reduced: true,
    text: 'Hidden objects are found on the processor, in WebAssembly, and never drawn. The two pictures are the same; the draws are not.',
    reference: { culling: 'off' },
    chosen: { culling: 'occlusion' },
    quick: ['culling'],
  },
  {
    key: 'variable',
    name: 'Variable shading',
    text: 'Light is found once per 1x1 to 2x2 pixels, as the contrast of the frame before allows. Where finding that out costs more than it saves, it turns itself off; Force keeps it on.',
    chosen: { shading: 'variable', rate: 'content', 'force-rate': true },
    quick: ['view', 'contrast-threshold', 'rate-4x4', 'force-rate'],
    views: ['final', 'rate', 'shaded', 'unknown'],
  },
  {
    key: 'stereo',
    name: 'Stereo',
    reduced: true,
    text: 'Each draw once for both eyes, against a pass per eye: the pictures are the same, the draws are half. Red-cyan glasses show depth; side by side is for crossed eyes or a headset.',
    reference: { stereo: 'two-pass', show: 'anaglyph-dubois', culling: 'occlusion' },
    chosen: { stereo: 'instanced', show: 'anaglyph-dubois', culling: 'occlusion' },
    quick: ['show', 'ipd', 'convergence'],
    shared: ['show', 'ipd', 'convergence'],
  },
  {
    key: 'both',
    name: 'All together',
    sum: true,
    text: 'Hidden objects culled, the fovea anti-aliased, the periphery coarse.',
    reference: { culling: 'off' },
    chosen: { culling: 'occlusion', shading: 'coarse', display: 'fhd-24', quality: 9.3, aa: 'msaa' },
    quick: ['view', 'composite', 'quality'],
    gaze: true,
    views: ['final', 'rate', 'blocks', 'shaded'],
  },
];
