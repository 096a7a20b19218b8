// What the page offers at one touch. `reference` and `chosen` are changes to the default settings; `quick` are the
// settings shown beside it, `still` is its picture where the page cannot draw.

export const TECHNIQUES = [
  {
    key: 'coarse',
    name: 'Coarse shading',
    text: 'Each region is lit once per block of pixels, 1 to 256 wide: fine where you look, coarse around. Let the gaze follow the pointer.',
    chosen: { shading: 'coarse' },
    quick: ['view', 'composite', 'fovea-inner'],
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
    text: 'Hidden objects are found on the processor, in WebAssembly, and never drawn. The two pictures are the same; the draws are not.',
    reference: { culling: 'off' },
    chosen: { culling: 'occlusion' },
    quick: ['culling'],
  },
  {
    key: 'both',
    name: 'All together',
    text: 'Hidden objects culled, the fovea anti-aliased, the periphery coarse.',
    reference: { culling: 'off' },
    chosen: { culling: 'occlusion', shading: 'coarse', aa: 'msaa' },
    quick: ['view', 'composite', 'fovea-inner'],
    gaze: true,
    views: ['final', 'rate', 'blocks', 'shaded'],
  },
];
