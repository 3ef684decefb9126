// A chart on two canvases: what was computed below, and what moves with the angle or the pointer above.

let palette = {};

function readPalette() {
  const names = ["page", "panel", "text", "soft", "line", "accent", "good", "bad", "c0", "c1", "c2", "c3", "c4", "c5"];
  palette = Object.fromEntries(names.map((name) => [name, colour(name)]));
}

const DASH = [[], [6, 4], [2, 3], [8, 3, 2, 3]];
const FONT = "12px system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";

class Chart {
  constructor(id, words) {
    this.box = document.getElementById(id);
    this.below = made("canvas", { role: "img", "aria-label": words });
    this.above = made("canvas", { "aria-hidden": "true" });
    this.key = made("div", { className: "key" });
    this.box.append(this.below, this.above);
    this.box.after(this.key);
    this.words = words;
    this.keyed = "";
    new ResizeObserver(() => { this.fit(); this.draw(); this.move(); }).observe(this.box);
    this.fit();
  }

  fit() {
    const { width, height } = this.box.getBoundingClientRect();
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    [this.width, this.height, this.ratio] = [width, height, ratio];
    for (const canvas of [this.below, this.above]) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      canvas.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
    }
  }

  // content: {curves: [{x, y, tint, dash, name, pale}], x: {label, range, log}, y: …, levels}
  show(content) {
    this.content = content;
    this.draw();
  }

  inner() {
    return { left: 56, right: this.width - (this.content && this.content.levels ? 68 : 14), top: 10, bottom: this.height - 40 };
  }

  X(value) {
    const { left, right } = this.inner();
    return left + (right - left) * shareOf(this.content.x.range, this.content.x.log, value);
  }

  Y(value) {
    const { top, bottom } = this.inner();
    return bottom - (bottom - top) * shareOf(this.content.y.range, this.content.y.log, value);
  }

  draw() {
    const { content, width, height } = this;
    const pen = this.below.getContext("2d");
    pen.clearRect(0, 0, width, height);
    if (!content || width < 50) return;
    this.axes(pen);
    const box = this.inner();
    pen.save();
    pen.beginPath();
    pen.rect(box.left, box.top - 1, box.right - box.left, box.bottom - box.top + 2);
    pen.clip();
    for (const curve of content.curves.filter((each) => each.pale)) this.line(pen, curve);
    for (const curve of content.curves.filter((each) => !each.pale)) this.line(pen, curve);
    pen.restore();
    this.levels(pen, box);
    this.fillKey();
  }

  axes(pen) {
    const { content } = this;
    const box = this.inner();
    const ticks = (axis, count) => (axis.log ? logTicksOf(...axis.range) : axis.ticks || ticksOf(...axis.range, count));
    pen.lineWidth = 1;
    let last = -1e9;
    for (const tick of ticks(content.x, (box.right - box.left) / 80)) {
      const x = Math.round(this.X(tick)) + 0.5;
      stroke(pen, x, box.top, x, box.bottom + 4, "line");
      if (x - last > 38) { write(pen, plain(tick), x, box.bottom + 6, "text", "center", "top"); last = x; }
    }
    last = 1e9;
    for (const tick of ticks(content.y, (box.bottom - box.top) / 45)) {
      const y = Math.round(this.Y(tick)) + 0.5;
      stroke(pen, box.left - 4, y, box.right, y, "line");
      if (last - y > 14) { write(pen, plain(tick), box.left - 7, y, "text", "right"); last = y; }
    }
    write(pen, content.x.label, 0.5 * (box.left + box.right), this.height - 6, "soft", "center", "alphabetic");
    pen.save();
    pen.translate(12, 0.5 * (box.top + box.bottom));
    pen.rotate(-Math.PI / 2);
    write(pen, content.y.label, 0, 0, "soft", "center", "alphabetic");
    pen.restore();
  }

  line(pen, curve) {
    pen.beginPath();
    pen.setLineDash(DASH[curve.dash || 0]);
    pen.strokeStyle = palette[curve.tint];
    pen.globalAlpha = curve.pale ? 0.35 : 1;
    pen.lineWidth = curve.pale ? 1.5 : 2;
    pen.lineJoin = "round";
    let down = false;
    for (let i = 0; i < curve.x.length; i += 1) {
      if (!Number.isFinite(curve.y[i])) { down = false; continue; }
      const [x, y] = [this.X(curve.x[i]), this.Y(curve.y[i])];
      if (down) pen.lineTo(x, y);
      else pen.moveTo(x, y);
      down = true;
    }
    pen.stroke();
    pen.setLineDash([]);
    if (curve.points) {
      for (let i = 0; i < curve.x.length; i += 1) if (Number.isFinite(curve.y[i])) dot(pen, this.X(curve.x[i]), this.Y(curve.y[i]), 2.5, curve.tint);
    }
    pen.globalAlpha = 1;
  }

  levels(pen, box) {
    for (const [value, words] of this.content.levels || []) {
      const y = this.Y(value);
      if (!Number.isFinite(y) || y < box.top || y > box.bottom) continue;
      stroke(pen, box.left, y, box.right, y, "soft", [6, 4]);
      write(pen, words, box.right + 4, y, "soft", "left");
    }
  }

  fillKey() {
    const named = this.content.curves.filter((each) => each.name && !each.pale);
    const text = named.map((each) => `${each.name}|${each.tint}|${each.dash || 0}`).join();
    if (text === this.keyed) return;
    this.keyed = text;
    this.key.replaceChildren(...named.map((curve) => {
      const sample = made("i", {});
      sample.style.borderTopColor = `var(--${curve.tint})`;
      sample.style.borderTopStyle = ["solid", "dashed", "dotted", "double"][curve.dash || 0];
      return made("span", {}, sample, curve.name);
    }));
  }

  // Say what is drawn, for who does not see it.
  describe() {
    const { content } = this;
    if (!content || !content.curves) return;
    const ranges = content.curves.filter((curve) => !curve.pale && curve.y.length).map((curve) => {
      const [low, high] = extent([curve.y]).map(plain);
      return `${curve.name || content.y.label} from ${low} to ${high}`;
    });
    this.below.setAttribute("aria-label", `${this.words}; ${content.y.label} over ${content.x.label}: ${ranges.join(", ")}`);
  }

  // What moves: a line at the angle, or points on the curve.
  move(moving) {
    if (moving) this.moving = moving;
    const pen = this.above.getContext("2d");
    pen.clearRect(0, 0, this.width, this.height);
    if (!this.content || !this.moving) return;
    const box = this.inner();
    if (this.moving.x !== undefined) {
      pen.lineWidth = 1.5;
      const x = this.X(this.moving.x);
      stroke(pen, x, box.top, x, box.bottom, "accent");
    }
    for (const [x, y, radius, tint] of this.moving.points || []) dot(pen, this.X(x), this.Y(y), radius, tint);
    if (this.moving.words) {
      pen.font = FONT;
      const wide = pen.measureText(this.moving.words).width;
      pen.fillStyle = palette.page;
      pen.globalAlpha = 0.85;
      pen.fillRect(box.right - wide - 8, box.top, wide + 8, 18);
      pen.globalAlpha = 1;
      write(pen, this.moving.words, box.right - 4, box.top + 3, "text", "right", "top");
    }
  }

  // Calls back with the place of the pointer, in pixels, while it is held down.
  whenDragged(act) {
    const told = (event) => {
      const box = this.above.getBoundingClientRect();
      act(event.clientX - box.left, event.clientY - box.top);
    };
    this.above.addEventListener("pointerdown", (event) => { this.above.setPointerCapture(event.pointerId); told(event); });
    this.above.addEventListener("pointermove", (event) => { if (event.buttons) told(event); });
  }

  valueX(pixel) {
    const { left, right } = this.inner();
    const { range, log } = this.content.x;
    return between(range, log, Math.min(Math.max((pixel - left) / (right - left), 0), 1));
  }
}

// Write a text at a place, no wider than `most` [px] where that is given.
function write(pen, text, x, y, tint, align, baseline = "middle", most = undefined) {
  pen.font = FONT;
  pen.fillStyle = palette[tint];
  pen.textAlign = align;
  pen.textBaseline = baseline;
  pen.fillText(text, x, y, most);
}

function stroke(pen, x, y, u, v, tint, dash = []) {
  pen.strokeStyle = palette[tint];
  pen.setLineDash(dash);
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(u, v);
  pen.stroke();
  pen.setLineDash([]);
}

function dot(pen, x, y, radius, tint) {
  pen.fillStyle = palette[tint];
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}
