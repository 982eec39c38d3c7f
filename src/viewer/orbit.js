// SPDX-License-Identifier: GPL-3.0-or-later
// The eye: it turns about a target; mouse, touch and keys move it.

class Orbit {
  constructor(canvas, { changed, clicked }) {
    this.canvas = canvas;
    this.changed = changed;
    this.heightRad = 0.7;
    Object.assign(this, { target: [0, 0, 0], distance: 10, azimuth: 0, elevation: 0.6, whole: 10 });
    const pointers = new Map();
    let way = 0;
    canvas.addEventListener("pointerdown", (e) => {
      canvas.setPointerCapture(e.pointerId);
      pointers.set(e.pointerId, e);
      if (pointers.size === 1) way = 0; else way = Infinity;  // two fingers do not click
    });
    canvas.addEventListener("pointermove", (e) => {
      const before = pointers.get(e.pointerId);
      if (!before) return;
      const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
      way += Math.hypot(dx, dy);
      if (pointers.size === 2) {
        const other = [...pointers.values()].find((p) => p.pointerId !== e.pointerId);
        const apart = (p) => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY) || 1;
        this.zoom(apart(before) / apart(e));
        this.pan(dx / 2, dy / 2);
      } else if (way > 3) {
        if (e.buttons & 6 || e.shiftKey) this.pan(dx, dy); else this.turn(dx, dy);
      }
      pointers.set(e.pointerId, e);
    });
    const end = (e) => {
      if (!pointers.delete(e.pointerId)) return;
      if (way <= 3 && e.type === "pointerup" && e.button === 0) clicked(e.offsetX, e.offsetY);
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoom(Math.exp(Math.sign(e.deltaY) * Math.min(Math.abs(e.deltaY), 120) * 0.0018));
    }, { passive: false });
    canvas.addEventListener("keydown", (e) => {
      const arrow = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
      if (arrow) e.shiftKey ? this.pan(24 * arrow[0], 24 * arrow[1]) : this.turn(24 * arrow[0], 24 * arrow[1]);
      else if (e.key === "+" || e.key === "=") this.zoom(0.8);
      else if (e.key === "-") this.zoom(1.25);
      else return;
      e.preventDefault();
    });
  }

  /// Unit vectors to the eye's back (away from what it sees), right and up.
  axes() {
    const c = Math.cos(this.elevation);
    const back = [c * Math.sin(this.azimuth), -c * Math.cos(this.azimuth), Math.sin(this.elevation)];
    const right = [Math.cos(this.azimuth), Math.sin(this.azimuth), 0];
    return { back, right, up: cross(back, right) };
  }
  turn(dx, dy) {
    this.azimuth -= dx * 0.007;
    this.elevation = Math.min(Math.max(this.elevation + dy * 0.007, -1.5), Math.PI / 2);
    this.changed();
  }
  pan(dx, dy) {
    const { right, up } = this.axes(), metres = 2 * this.distance * Math.tan(this.heightRad / 2) / this.canvas.clientHeight;
    this.target = plus(plus(this.target, right, -dx * metres), up, dy * metres);
    this.changed();
  }
  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, this.whole * 1e-5), this.whole * 50);
    this.changed();
  }
  /// Shows places, given as x, y, z one after another, as large as they fit; `spare` times that from farther off.
  frame(points, spare = 1.1) {
    const { back, right, up } = this.axes(), { middle } = ballOf(points), tall = Math.tan(this.heightRad / 2) / spare;
    const wide = tall * this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    // In units where the view's borders are at 45 degrees: every place bounds the eye from four sides.
    const most = [-Infinity, -Infinity, -Infinity, -Infinity];
    const step = 3 * Math.max(1, Math.floor(points.length / 30000));
    for (let i = 0; i < points.length; i += step) {
      const p = minus([points[i], points[i + 1], points[i + 2]], middle), depth = dot(p, back);
      [dot(p, right) / wide, -dot(p, right) / wide, dot(p, up) / tall, -dot(p, up) / tall]
        .forEach((v, k) => { most[k] = Math.max(most[k], v + depth); });
    }
    if (!Number.isFinite(most[0])) most.fill(10);
    this.target = plus(plus(middle, right, wide * (most[0] - most[1]) / 2), up, tall * (most[2] - most[3]) / 2);
    this.distance = Math.max((most[0] + most[1]) / 2, (most[2] + most[3]) / 2, 1e-3);
    this.changed();
  }
  matrix() {
    const { back, up } = this.axes(), eye = plus(this.target, back, this.distance);
    const near = this.distance / 100, far = this.distance + 6 * this.whole;
    const aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    return product(perspective(this.heightRad, aspect, near, far), looking(eye, this.target, up));
  }
}
