// The automatic resolution: as many pixels as can be drawn in time.

const SLOW_MS = 250;
const FAST_MS = 40;

/** Slow frames in succession before the resolution falls: the first ones after a change wait for pipelines to be compiled. */
const SLOW_FRAMES = 3;

const LEAST_SCALE = 0.25;

export class Resolution {
  constructor() {
    this.reset();
  }

  reset() {
    /** Of the full width and height. */
    this.scale = 1;
    this.slow = 0;
  }

  /** Something changed for which pipelines may have to be compiled. */
  changed() {
    this.slow = 0;
  }

  /** Halves while frames are slow, doubles when there is time; tells whether the scale is another after a frame of `ms`. */
  adapt(ms) {
    this.slow = ms > SLOW_MS ? this.slow + 1 : 0;
    const before = this.scale;
    if (this.slow >= SLOW_FRAMES) this.scale = Math.max(LEAST_SCALE, this.scale / 2);
    else if (ms < FAST_MS) this.scale = Math.min(1, this.scale * 2);
    return this.scale !== before;
  }
}
