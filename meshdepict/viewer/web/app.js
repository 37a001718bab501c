/* The page of `meshdepict view --browser`: a picture and the controls of its method.
   Trame carries changes to the program and its answers back; the picture is drawn here. */
"use strict";

(() => {
  const DEGREES = 180 / Math.PI;
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

  const PANEL = `
    <main class="depict">
      <section class="stage">
        <p v-if="fault" class="fault" role="alert">{{ fault }}</p>
        <canvas v-show="!fault" ref="canvas" tabindex="0" role="img" @keydown="parted"
          :aria-label="'Picture of ' + look.title + '. Arrow keys turn it, plus and minus zoom.'"
        ></canvas>
        <p class="help">Drag or arrow keys: turn. Wheel or + −: zoom. Shift: move. Home: back.
          w: before and after. [ ] or drag: the line.
          <span v-if="look.place">Alt+click: {{ words(look.place) }}.</span></p>
      </section>
      <form class="panel" @submit.prevent>
        <div class="scroll">
        <h1>{{ look.title }}</h1>
        <label class="row">Method
          <select id="method" :value="look.method" @change="method($event.target.value)">
            <option v-for="name in look.methods" :key="name" :value="name">{{ words(name) }}
            </option>
          </select>
        </label>
        <p class="about">{{ look.about }}</p>

        <fieldset>
          <legend>Light</legend>
          <div class="light">
            <svg class="pad" ref="pad" viewBox="-1.12 -1.12 2.24 2.24" tabindex="0" role="img"
              :aria-label="lightText" @pointerdown="grab" @pointermove="drag" @keydown="nudge">
              <circle class="sky" r="1" /><circle class="ring" r="0.667" />
              <circle class="ring" r="0.333" />
              <path class="ring" d="M-1 0H1M0-1V1" />
              <circle v-if="angles" class="sun" :class="{ behind: angles.elevation < 0 }" r="0.1"
                :cx="sun[0]" :cy="sun[1]" />
            </svg>
            <div v-if="angles" class="angles">
              <label>azimuth <input id="azimuth" type="number" step="5"
                :value="Math.round(angles.azimuth)"
                @change="aim(+$event.target.value, angles.elevation)">°</label>
              <label>elevation <input id="elevation" type="number" step="5" min="-90" max="90"
                :value="Math.round(angles.elevation)"
                @change="aim(angles.azimuth, clamp(+$event.target.value, -90, 90))">°</label>
            </div>
            <p v-else class="about">{{ look.lightText }}</p>
          </div>
          <label class="check"><input id="follow" type="checkbox"
            :checked="look.follows" @change="change('follow', $event.target.checked)">
            turns with the view</label>
        </fieldset>

        <fieldset v-if="look.controls.length">
          <legend>Options</legend>
          <div v-for="control in look.controls" :key="look.method + control.name"
            :class="['option', control.kind]" :title="control.help">
            <label :for="'option-' + control.name">{{ control.label }}</label>
            <span class="value">
              <button v-if="control.changed" type="button" class="undo"
                :aria-label="'Default of ' + control.label" title="back to the default"
                @click="option(control, null)">↺</button>
              <button v-for="word in control.words" v-show="control.word !== word" :key="word"
                type="button" class="undo" :id="word + '-' + control.name"
                :title="control.label + ': ' + word"
                @click="option(control, word)">{{ word }}</button>
              <output :for="'option-' + control.name">{{ said(control) }}</output>
            </span>
            <input v-if="control.kind === 'slider'" type="range" :id="'option-' + control.name"
              :min="control.low" :max="control.high" :step="control.step || 'any'"
              :value="control.value" @input="option(control, +$event.target.value)">
            <select v-else-if="control.kind === 'list'" :id="'option-' + control.name"
              :value="control.value" @change="option(control, $event.target.value)">
              <option v-for="name in control.choices" :key="name">{{ name }}</option>
            </select>
            <input v-else type="text" :id="'option-' + control.name" :value="control.value"
              placeholder="–" @change="option(control, $event.target.value || null)">
          </div>
        </fieldset>

        <label class="row">Colour map
          <input id="colormap" type="text" list="maps" :value="look.colormap" placeholder="gray"
            spellcheck="false" @change="change('colormap', $event.target.value.trim() || null)">
          <datalist id="maps"><option v-for="name in look.colormaps" :key="name">{{ name }}</option>
          </datalist>
        </label>

        <fieldset>
          <legend>Before and after</legend>
          <label class="row">left of the line
            <select id="compared" :value="compared" @change="compare($event.target.value)">
              <option value="">nothing</option>
              <option v-for="each in look.comparisons" :key="each.name" :value="each.name">
                {{ each.words }}</option>
            </select>
          </label>
          <p v-if="look.texture !== null" class="row texture">
            <span>{{ look.texture || 'colours at the vertices' }}</span>
            <button id="texture" type="button" @click="change('texture', !look.texture)">
              {{ look.texture ? 'Leave the texture' : 'Bake a texture' }}</button></p>
        </fieldset>
        </div>
        <div class="foot">
        <p v-if="message" class="message" role="alert">{{ message }}</p>
        <p class="status" role="status">{{ status }}</p>
        <div class="buttons">
          <button id="reset" type="button" @click="change('reset')">Reset</button>
          <span class="save">Save
            <button v-for="kind in look.kinds" :key="kind" type="button"
              :id="'save-' + kind" @click="save(kind)">{{ kind }}</button></span>
        </div>
        </div>
      </form>
    </main>`;

  const App = {
    template: PANEL,
    inject: ["trame"],
    data() {
      const state = this.trame.state;
      return {
        look: state.get("look"), frame: null, fault: "", message: "", slow: false,
        progress: 0, loading: "the mesh",
      };
    },
    computed: {
      angles() {
        if (!this.look.light || !this.frame) return null;
        const [x, y, z] = this.frame.map((axis) => axis.reduce(
          (sum, a, i) => sum + a * this.look.light[i], 0));
        const azimuth = (Math.atan2(x, y) * DEGREES + 360) % 360;
        return { azimuth, elevation: Math.asin(clamp(z, -1, 1)) * DEGREES };
      },
      sun() { // elevation 90° in the middle, the horizon on the rim
        const radius = Math.min((90 - this.angles.elevation) / 90, 1);
        const turn = this.angles.azimuth / DEGREES;
        return [radius * Math.sin(turn), -radius * Math.cos(turn)];
      },
      lightText() {
        if (!this.angles) return `Light: ${this.look.lightText}`;
        const [a, e] = [this.angles.azimuth, this.angles.elevation].map(Math.round);
        return `Light from azimuth ${a}°, elevation ${e}°. Arrow keys move it.`;
      },
      status() {
        if (this.loading) return `loading ${this.loading} …`;
        if (!this.slow) return "";
        return this.progress ? `computing, ${Math.round(100 * this.progress)} %` : "computing …";
      },
    },
    mounted() {
      this.me = crypto.randomUUID();
      this.waiting = new Map(); // the latest of each change that is not sent yet
      this.sent = this.serial = 0;
      try {
        this.view = new window.MeshView(this.$refs.canvas, (sight) => this.turned(sight),
          (x, y) => this.attend(x, y));
      } catch (error) {
        this.fault = error.message;
        return;
      }
      this.deafen = this.trame.state.addListener(({ type, keys }) => {
        if (type === "dirty-state") this.heard(keys);
      });
      this.begin();
    },
    beforeUnmount() {
      if (this.deafen) this.deafen();
      clearTimeout(this.timer);
      if (this.view) this.view.leave();
    },
    methods: {
      clamp,
      words: (name) => name.replaceAll("_", " "),
      said(control) {
        if (control.kind !== "slider") return "";
        if (control.word) return control.word;
        const number = Number(Number(control.value).toPrecision(3));
        return control.unset ? "auto" : `${number} ${control.unit}`;
      },
      async begin() {
        const { mesh, home } = ["mesh", "home"].reduce(
          (all, key) => ({ ...all, [key]: this.trame.state.get(key) }), {});
        try {
          this.view.show(await (await this.fetched("depict/mesh")).arrayBuffer(), mesh);
        } catch (error) {
          this.loading = "";
          this.fault = `The mesh could not be loaded: ${error.message}`;
          return;
        }
        this.view.look(home);
        this.frame = home.frame;
        this.loading = "its colours";
        this.paint();
      },

      /* --- what the program says ------------------------------------------------------ */

      heard(keys) {
        const state = this.trame.state;
        if (keys.includes("progress")) this.progress = state.get("progress");
        if (keys.includes("message")) this.message = state.get("message");
        if (keys.includes("mesh") && this.view.info) this.view.stretch(state.get("mesh"));
        if (keys.includes("home") && this.view.info) {
          this.view.look(state.get("home"));
          this.frame = this.view.sight.frame;
        }
        if (keys.includes("revision") && this.view.info) this.paint();
        else if (keys.includes("texture") && this.view.info) this.dress();
        if (keys.includes("applied") && state.get("applied")[this.me] === this.sent) {
          this.sent = 0;
          this.slow = false;
          clearTimeout(this.timer);
          this.view.settle();
          this.send();
        }
        if (!this.sent) this.look = state.get("look"); // else a slider would jump back
      },
      async paint() { // one at a time, and then the newest
        if (this.painting) {
          this.painting = "again";
          return;
        }
        do {
          this.painting = "once";
          const revision = this.trame.state.get("revision");
          try {
            const answer = await this.fetched(`depict/colors?${revision}`);
            this.view.paint(await answer.arrayBuffer());
            this.$refs.canvas.dataset.revision = revision;
          } catch (error) {
            this.message = `The colours could not be loaded: ${error.message}`;
          }
          this.loading = "";
        } while (this.painting === "again");
        this.painting = "";
        this.dress();
      },
      async fetched(address) {
        const answer = await fetch(address);
        if (!answer.ok) throw new Error(await answer.text());
        return answer;
      },

      /* --- what a person says --------------------------------------------------------- */

      /* One batch is on its way at a time; meanwhile the latest of each change waits. */
      change(kind, ...values) {
        const key = kind === "option" ? `option ${values[1]}` : kind;
        this.waiting.delete(key);
        this.waiting.set(key, [kind, ...values]);
        this.message = "";
        this.send();
      },
      send() {
        if (this.sent || !this.waiting.size) return;
        this.sent = ++this.serial;
        this.view.hold();
        this.timer = setTimeout(() => { this.slow = true; }, 300);
        const batch = [...this.waiting.values()];
        this.waiting.clear();
        // Refused only where the line is dead, which trame says in place of this page.
        this.trame.trigger("change", [this.me, this.sent, batch]).catch(() => {});
      },
      method(name) {
        this.look.method = name;
        this.change("method", name);
      },
      option(control, value) {
        control.word = control.words.includes(value) ? value : "";
        if (value !== null && !control.word) control.value = value;
        control.unset = value === null && control.unset;
        this.change("option", this.look.method, control.name, value);
      },
      turned(sight) {
        const { angles } = this;
        this.frame = sight.frame;
        this.change("view", sight.frame, sight.focus, this.view.halfHeight());
        if (this.look.follows && angles) this.look.light = this.direction(angles);
      },
      attend(x, y) { // at a place of the canvas, in its pixels
        if (this.look.place) this.change("attend", window.pickPoint(this.view, x, y));
      },
      direction({ azimuth, elevation }) { // degrees in the view's frame, clockwise from up
        const [a, e] = [azimuth / DEGREES, elevation / DEGREES];
        const seen = [Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)];
        return [0, 1, 2].map((i) => this.frame.reduce((sum, axis, k) => sum + axis[i] * seen[k], 0));
      },
      aim(azimuth, elevation) {
        this.look.light = this.direction({ azimuth, elevation });
        this.change("light", this.look.light);
      },
      grab(event) {
        this.$refs.pad.setPointerCapture(event.pointerId);
        this.drag(event, true);
      },
      drag(event, pressed = false) {
        if (!pressed && !(event.buttons & 1)) return;
        const box = this.$refs.pad.getBoundingClientRect();
        const x = (event.clientX - box.left - box.width / 2) * (2.24 / box.width);
        const y = (box.top + box.height / 2 - event.clientY) * (2.24 / box.height);
        this.aim(Math.atan2(x, y) * DEGREES, 90 * (1 - Math.min(Math.hypot(x, y), 1)));
      },
      nudge(event) {
        const step = {
          ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5],
        }[event.key];
        if (!step) return;
        event.preventDefault();
        const { azimuth, elevation } = this.angles || { azimuth: 315, elevation: 35 };
        this.aim(azimuth + step[0], clamp(elevation + step[1], -90, 90));
      },
      async save(kind) {
        const { width, height } = this.$refs.canvas;
        try {
          const answer = await this.fetched(`depict/save/${kind}?width=${width}&height=${height}`);
          const link = document.createElement("a");
          link.href = URL.createObjectURL(await answer.blob());
          link.download = answer.headers.get("X-File-Name");
          link.click();
          setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
        } catch (error) {
          this.message = error.message;
        }
      },
    },
  };

  window.meshdepict = {
    install(app) { // by now all scripts are there, which come in any order
      app.component("depict-app", { ...App, mixins: [window.looks] });
    },
  };
})();
