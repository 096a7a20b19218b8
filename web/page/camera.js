// The camera: fly (drag to look, WASD to move) or orbit, by mouse, touch and keyboard.

const STEP_RAD = 0.04;

/** Radians that are none: what numbers of 32 bits and of links are rounded by. */
const NONE_RAD = 1e-4;

const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);

export class Camera {
  /** `moved()` is called after each change. */
  constructor(canvas, moved) {
    this.orbit = false;
    this.keys = new Set();
    this.pointers = new Map();
    this.moved = moved;
    this.reset({ eye: [0, 0, 1], target: [0, 0, 0], fov_y_deg: 50, near_m: 0.05 }, 1);
    this.listen(canvas);
  }

  /** `place` may lack `up`: then nothing leans. */
  reset(place, radius) {
    this.eye = [...place.eye];
    this.fov = place.fov_y_deg;
    this.near = place.near_m;
    const forward = place.target.map((t, i) => t - place.eye[i]);
    this.distance = Math.hypot(...forward) || 1;
    this.face(forward, place.up ?? [0, 1, 0]);
    this.pace = radius / 60;
  }

  /** Looks along `forward`, with `up` upwards in the picture. */
  face(forward, up) {
    const level = Math.hypot(forward[0], forward[2]);
    // Straight down `up` alone says which way is ahead, straight up its opposite does.
    const ahead = level > NONE_RAD * this.distance ? forward : up.map((v) => -Math.sign(forward[1]) * v);
    this.yaw = Math.atan2(ahead[0], 0 - ahead[2]);
    this.pitch = Math.atan2(forward[1], level);
    this.roll = 0;
    const roll = Math.atan2(dot(up, this.right), dot(up, this.up));
    if (Math.abs(roll) > NONE_RAD) this.roll = roll;
  }

  get forward() {
    const level = Math.cos(this.pitch);
    return [Math.sin(this.yaw) * level, Math.sin(this.pitch), -Math.cos(this.yaw) * level];
  }

  /** To the right in the picture, before it leans by `roll` to the right. */
  get level() {
    return [Math.cos(this.yaw), 0, Math.sin(this.yaw)];
  }

  /** Upwards in the picture, before it leans. */
  get upright() {
    const steep = Math.sin(this.pitch);
    return [-Math.sin(this.yaw) * steep, Math.cos(this.pitch), Math.cos(this.yaw) * steep];
  }

  get right() {
    return this.lean(this.level, this.upright, -1);
  }

  get up() {
    return this.lean(this.upright, this.level, 1);
  }

  lean(axis, other, sign) {
    return axis.map((v, i) => v * Math.cos(this.roll) + sign * other[i] * Math.sin(this.roll));
  }

  place() {
    const target = this.eye.map((e, i) => e + this.forward[i] * this.distance);
    return { eye: this.eye, target, up: this.up, fov_y_deg: this.fov, near_m: this.near };
  }

  /** Turns to the right and upwards in the picture, by radians. */
  turn(right, up) {
    const pivot = this.eye.map((e, i) => e + this.forward[i] * this.distance);
    const [cos, sin] = [Math.cos(this.roll), Math.sin(this.roll)];
    this.yaw += right * cos + up * sin;
    this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + up * cos - right * sin));
    if (this.orbit) this.eye = pivot.map((p, i) => p - this.forward[i] * this.distance);
    this.moved();
  }

  move(right, up, ahead) {
    const [side, f] = [this.right, this.forward];
    if (this.orbit && ahead) {
      const distance = Math.max(this.pace * 0.05, this.distance - ahead);
      ahead = this.distance - distance;
      this.distance = distance;
    }
    this.eye = this.eye.map((e, i) => e + side[i] * right + f[i] * ahead + (i === 1 ? up : 0));
    this.moved();
  }

  /** One step of the keys that are held; true while there are any. */
  step(seconds) {
    const held = (key) => (this.keys.has(key) ? 1 : 0);
    const pace = this.pace * (this.keys.has('shift') ? 40 : 10) * Math.min(seconds, 0.1);
    const right = held('d') - held('a');
    const up = held('e') - held('q');
    const ahead = held('w') - held('s');
    if (right || up || ahead) this.move(right * pace, up * pace, ahead * pace);
    return this.keys.size > 0;
  }

  listen(canvas) {
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    const release = (event) => this.pointers.delete(event.pointerId);
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('pointermove', (event) => {
      // Nobody tells the page of a button that is let go in a context menu.
      if (!event.buttons) release(event);
      const before = this.pointers.get(event.pointerId);
      if (!before) return;
      const now = [event.clientX, event.clientY];
      const spread = this.spread();
      this.pointers.set(event.pointerId, now);
      const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
      const perPixel = ((this.fov * Math.PI) / 180 / canvas.clientHeight) * (this.orbit ? 2.5 : 1);
      if (this.pointers.size === 1) this.turn((this.orbit ? 1 : -1) * dx * perPixel, (this.orbit ? -1 : 1) * dy * perPixel);
      else this.move(-dx * this.pace * 0.05, dy * this.pace * 0.05, (this.spread() - spread) * this.pace * 0.2);
    });
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.move(0, 0, -Math.sign(event.deltaY) * this.pace * 3);
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      const turn = turns[event.key];
      const key = event.key.toLowerCase();
      if (turn) this.turn(turn[0] * STEP_RAD, turn[1] * STEP_RAD);
      else if ('wasdqe'.includes(key) || key === 'shift') this.keys.add(key);
      else return;
      event.preventDefault();
      this.moved();
    });
    canvas.addEventListener('keyup', (event) => this.keys.delete(event.key.toLowerCase()));
    canvas.addEventListener('blur', () => this.keys.clear());
  }

  /** How far apart two fingers are. */
  spread() {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }
}
