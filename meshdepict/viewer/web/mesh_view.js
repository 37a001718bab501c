/* A mesh as it looks, unlit, in a parallel projection; before and after, parted by a line. Turned
   by mouse, touch and keys.
   Used by the page that `Baked.save("x.html")` writes and by `meshdepict view --browser`. */
"use strict";

window.MeshView = (() => {
  const STEP = Math.PI / 36; // a key press turns by 5°
  const STILL = 400; // ms without a change
  const SWIFT = 25; // ms: a picture that comes faster may always be smooth
  const LINE = [0.85, 0.33, 0.1]; // the window's
  const GRIP = { mouse: 8, touch: 24 }; // pixels beside it where it can be taken
  const SHIFT = 0.02; // of it for a key, in widths of the picture

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
  ];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));
  const blend = (a, x, b, y) => a.map((_, i) => a[i] * x + b[i] * y);

  class MeshView {
    /* `turned(sight)` is called when a person changes the view, `clicked(x, y)` when one clicks a
       place with Alt; `info` describes the mesh. `now` is how it looks, `before` how it did, to the
       left of the `line`, a share of the width. */
    constructor(canvas, turned = () => {}, clicked = null) {
      this.clicked = clicked;
      this.canvas = canvas;
      this.turned = turned;
      this.fingers = new Map();
      this.sight = null;
      this.frames = 0;
      this.now = this.before = this.vertices = null;
      this.line = 0.5;
      this.gl = canvas.getContext("webgl2", { antialias: false }); // see `smoothed`
      if (!this.gl) throw new Error("This browser has no WebGL 2, which the picture needs.");
      this.prepare();
      canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
      canvas.addEventListener("webglcontextrestored", () => {
        this.prepare();
        const looks = new Set([this.now, this.before, this.vertices].filter(Boolean));
        for (const look of looks) {
          look.painter = null;
          look.load(this.painter).then(() => this.draw());
        }
      });
      this.sized = new ResizeObserver(() => this.draw());
      this.sized.observe(canvas);
      this.listen();
    }

    prepare() {
      this.painter = new window.Appearance.Painter(this.gl);
      this.gl.enable(this.gl.DEPTH_TEST);
      this.samples = null;
    }

    /* Take a mesh: the bytes of `packing.pack_mesh` and what it says about them. */
    show(buffer, info) {
      const points = 6 * info.vertices;
      const Index = info.wide ? Uint32Array : Uint16Array;
      this.info = info;
      const { summed } = window.Appearance;
      this.positions = summed(new Uint16Array(buffer.slice(0, points)), 3);
      this.indices = summed(new Index(buffer.slice(points)), 1);
      this.measure();
    }

    measure() {
      const { low, span } = this.info;
      this.middle = low.map((x, i) => x + span[i] / 2);
      this.radius = Math.hypot(...span) / 2 || 1;
    }

    /* The same numbers stand for other places: terrain is raised. What is looked at stays so. */
    stretch(info) {
      const before = this.info;
      this.info = info;
      this.measure();
      const moved = (sight) => sight && { ...sight, focus: sight.focus.map((x, i) => info.low[i]
        + ((x - before.low[i]) * info.span[i]) / before.span[i]) };
      [this.sight, this.home] = [moved(this.sight), moved(this.home)];
      this.draw();
    }

    /* Take new colours, three bytes a vertex, and show them. */
    paint(buffer) {
      if (this.vertices) this.vertices.paint(buffer);
      else this.vertices = window.Appearance.painted(buffer, this).place(this.painter);
      this.now = this.vertices;
      this.draw();
    }

    /* Show the mesh as it looks by an appearance that was loaded. */
    wear(appearance) {
      this.now = appearance;
      this.draw();
    }

    /* Show another appearance, too, on the left; or none. */
    compare(appearance) {
      if (this.before === appearance) return;
      this.before = appearance;
      this.draw();
    }

    moveLine(share) {
      this.line = Math.min(Math.max(share, 0), 1);
      this.draw();
    }

    /* Look from a place: rows right, up and towards the eye; the focus; half the height. */
    look(sight) {
      this.sight = { frame: sight.frame, focus: sight.focus, scale: sight.scale };
      this.home = this.home || this.sight;
      this.draw();
    }

    /* Smooth edges cost a software renderer three times as much: where drawing is slow, they come
       once the picture has been still for a moment. */
    draw() {
      if (!this.waiting) {
        this.waiting = requestAnimationFrame(() => {
          this.waiting = 0;
          this.render(this.swift === true);
        });
      }
      this.settle();
    }

    /* The canvas goes away: nothing is drawn any more. */
    leave() {
      this.sized.disconnect();
      cancelAnimationFrame(this.waiting);
      clearTimeout(this.rest);
      this.sight = null;
    }

    /* Something is on its way that will be drawn. */
    hold() {
      clearTimeout(this.rest);
    }

    /* Nothing more is known to come. */
    settle() {
      clearTimeout(this.rest);
      if (this.swift !== true) this.rest = setTimeout(() => this.finish(), STILL);
    }

    finish() {
      const start = performance.now();
      this.render(true);
      if (this.swift === undefined && this.now && this.sight) { // asked once: it waits
        this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
        this.swift = performance.now() - start < SWIFT;
      }
    }

    render(smooth) {
      const { gl, canvas } = this;
      if (!this.now?.painter || !this.sight || !canvas.isConnected || gl.isContextLost()) return;
      const density = window.devicePixelRatio || 1;
      const width = Math.max(1, Math.round(canvas.clientWidth * density));
      const height = Math.max(1, Math.round(canvas.clientHeight * density));
      if (canvas.width !== width || canvas.height !== height) {
        [canvas.width, canvas.height] = [width, height];
      }
      gl.bindFramebuffer(gl.FRAMEBUFFER, smooth ? this.smoothed(width, height) : null);
      gl.viewport(0, 0, width, height);
      const paper = getComputedStyle(canvas).backgroundColor.match(/[\d.]+/g).map(Number);
      gl.clearColor(paper[0] / 255, paper[1] / 255, paper[2] / 255, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      this.painter.look(this.matrix(width / height));
      if (this.before?.painter) this.drawBoth(width, height, density);
      else this.now.draw();
      if (smooth) {
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
        const box = [0, 0, width, height];
        gl.blitFramebuffer(...box, ...box, gl.COLOR_BUFFER_BIT, gl.NEAREST);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      }
      canvas.dataset.smooth = smooth;
      canvas.dataset.frames = ++this.frames;
    }

    drawBoth(width, height, density) {
      const { gl } = this;
      const cut = Math.round(this.line * width);
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, 0, cut, height);
      this.before.draw();
      gl.scissor(cut, 0, width - cut, height);
      this.now.draw();
      gl.scissor(cut - Math.ceil(density), 0, 2 * Math.ceil(density), height);
      gl.clearColor(...LINE, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.disable(gl.SCISSOR_TEST);
    }

    /* A framebuffer of four samples a pixel. */
    smoothed(width, height) {
      const { gl, samples } = this;
      if (samples && samples.width === width && samples.height === height) return samples.buffer;
      if (samples) {
        samples.parts.forEach((part) => gl.deleteRenderbuffer(part));
        gl.deleteFramebuffer(samples.buffer);
      }
      const buffer = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
      const parts = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]
        .map(([format, place]) => {
          const part = gl.createRenderbuffer();
          gl.bindRenderbuffer(gl.RENDERBUFFER, part);
          gl.renderbufferStorageMultisample(gl.RENDERBUFFER, 4, format, width, height);
          gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, part);
          return part;
        });
      this.samples = { buffer, parts, width, height };
      return buffer;
    }

    /* Half the height in world units: what fits into a square fits into a narrow page, too. */
    halfHeight() {
      const aspect = this.canvas.clientWidth / this.canvas.clientHeight;
      return this.sight.scale / Math.min(1, aspect);
    }

    /* From numbers in [0, 1] along the box's sides to clip space, column by column. */
    matrix(aspect) {
      const { low, span } = this.info;
      const [right, up, eye] = this.sight.frame;
      const half = this.halfHeight();
      const rows = [[right, 1 / (half * aspect), this.sight.focus], [up, 1 / half, this.sight.focus],
        [eye, -1 / (1.01 * this.radius), this.middle]];
      const filled = rows.map(([axis, factor, origin]) => [
        ...axis.map((x, i) => x * span[i] * factor),
        factor * dot(axis, low.map((x, i) => x - origin[i])),
      ]);
      filled.push([0, 0, 0, 1]);
      return new Float32Array([0, 1, 2, 3].flatMap((column) => filled.map((row) => row[column])));
    }

    /* --- what a person does ------------------------------------------------------------- */

    moved(change) {
      if (!this.sight) return;
      this.sight = { ...this.sight, ...change };
      this.draw();
      this.turned(this.sight);
    }

    turn(aside, down) {
      const [right, up, eye] = this.sight.frame;
      const [c, s, k, t] = [Math.cos(aside), Math.sin(aside), Math.cos(down), Math.sin(down)];
      const x = blend(right, c, eye, s);
      const z = blend(eye, c, right, -s);
      const towards = unit(blend(z, k, up, t));
      const across = unit(cross(cross(towards, x), towards));
      this.moved({ frame: [across, cross(towards, across), towards] });
    }

    shift(x, y) { // in pixels
      const unitsPerPixel = (2 * this.halfHeight()) / this.canvas.clientHeight;
      const [right, up] = this.sight.frame;
      const step = blend(right, -x * unitsPerPixel, up, y * unitsPerPixel);
      this.moved({ focus: this.sight.focus.map((f, i) => f + step[i]) });
    }

    zoom(factor) {
      const scale = this.sight.scale * factor;
      this.moved({ scale: Math.min(Math.max(scale, this.radius * 1e-4), this.radius * 50) });
    }

    goHome() {
      this.moved(this.home);
    }

    /* Whether the line is under the pointer. */
    grips(event) {
      const aside = Math.abs(event.offsetX - this.line * this.canvas.clientWidth);
      return this.before !== null && aside <= (GRIP[event.pointerType] || GRIP.touch);
    }

    listen() {
      const { canvas, fingers } = this;
      canvas.style.touchAction = "none";
      canvas.addEventListener("contextmenu", (event) => event.preventDefault());
      canvas.addEventListener("pointerdown", (event) => {
        if (event.altKey && this.clicked) {
          this.clicked(event.offsetX, event.offsetY);
          return;
        }
        canvas.setPointerCapture(event.pointerId);
        if (!fingers.size && this.grips(event)) this.gripped = event.pointerId;
        fingers.set(event.pointerId, [event.clientX, event.clientY]);
      });
      for (const name of ["pointerup", "pointercancel"]) {
        canvas.addEventListener(name, (event) => {
          fingers.delete(event.pointerId);
          if (this.gripped === event.pointerId) this.gripped = null;
        });
      }
      canvas.addEventListener("pointermove", (event) => {
        if (!fingers.size) canvas.style.cursor = this.grips(event) ? "ew-resize" : "";
        if (this.gripped === event.pointerId) {
          this.moveLine(event.offsetX / canvas.clientWidth);
          return;
        }
        const before = fingers.get(event.pointerId);
        if (!before || !this.sight) return;
        const now = [event.clientX, event.clientY];
        const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
        const other = [...fingers].find(([id]) => id !== event.pointerId);
        fingers.set(event.pointerId, now);
        if (other) {
          const apart = (finger) => Math.hypot(finger[0] - other[1][0], finger[1] - other[1][1]);
          this.zoom(apart(before) / Math.max(apart(now), 1));
          this.shift(dx / 2, dy / 2);
        } else if (event.shiftKey || event.buttons & 6) {
          this.shift(dx, dy);
        } else {
          const full = Math.min(canvas.clientWidth, canvas.clientHeight);
          this.turn((Math.PI * dx) / full, (Math.PI * dy) / full);
        }
      });
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        if (this.sight) this.zoom(Math.exp(event.deltaY * lines * 1e-3));
      }, { passive: false });
      canvas.addEventListener("dblclick", () => this.goHome());
      canvas.addEventListener("keydown", (event) => this.key(event));
    }

    key(event) {
      if (!this.sight || event.ctrlKey || event.altKey || event.metaKey) return;
      const arrows = {
        ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
      };
      const arrow = arrows[event.key];
      if (arrow && event.shiftKey) this.shift(20 * arrow[0], 20 * arrow[1]);
      else if (arrow) this.turn(STEP * arrow[0], STEP * arrow[1]);
      else if (event.key === "+" || event.key === "=") this.zoom(1 / 1.1);
      else if (event.key === "-") this.zoom(1.1);
      else if (event.key === "Home" || event.key === "0") this.goHome();
      else if (event.key === "[" || event.key === "]") {
        if (this.before) this.moveLine(this.line + (event.key === "[" ? -SHIFT : SHIFT));
      }
      else return;
      event.preventDefault();
    }
  }

  return MeshView;
})();
