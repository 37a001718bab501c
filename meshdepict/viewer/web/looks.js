/* What the page of `meshdepict view --browser` shows beside colours at the vertices: a texture that
   the program has baked, and how the mesh was before. A part of the component in `app.js`. */
"use strict";

window.looks = {
  data: () => ({ compared: "" }),
  mounted() {
    this.worn = 0; // the number of the texture that is shown
    this.last = ""; // what lay to the left of the line last
    this.kept = {}; // looks that were loaded, by name
    this.dressing = Promise.resolve();
  },
  methods: {
    /* Bring what is shown up to date: one at a time, as all of them wait for the program. */
    dress() {
      this.dressing = this.dressing.then(() => this.dressNow()).catch((error) => {
        this.message = `The picture could not be loaded: ${error.message}`;
      });
    },
    async dressNow() {
      const { view } = this;
      const texture = this.trame.state.get("texture");
      if (texture !== this.worn) {
        this.leave("texture");
        this.worn = texture;
        if (texture) this.loading = "the texture";
        view.wear(texture ? await this.received("texture", texture) : view.vertices);
      }
      if (this.compared === "vertices" && !texture) this.compared = "";
      const before = this.compared === "before"
        ? await this.received("before", this.look.own ? "own" : view.canvas.dataset.revision)
        : this.compared && view.vertices;
      view.compare(before || null);
      this.loading = "";
      Object.assign(view.canvas.dataset, { texture, compared: this.compared });
    },
    /* Return a look, fetched anew where it is another one by now. */
    async received(name, version) {
      if (this.kept[name]?.version !== version) {
        const answer = await this.fetched(`depict/appearance/${name}?${version}`);
        const look = window.Appearance.received(await answer.arrayBuffer(), this.view);
        await look.load(this.view.painter);
        this.leave(name);
        this.kept[name] = { look, version };
        if (look.note) this.message = look.note;
      }
      return this.kept[name].look;
    },
    leave(name) {
      if (this.kept[name]) this.kept[name].look.drop();
      delete this.kept[name];
    },
    compare(what) {
      if (what) this.last = what;
      this.compared = what;
      this.dress();
    },
    parted(event) { // by the key w
      if (event.key.toLowerCase() !== "w" || event.ctrlKey || event.altKey || event.metaKey) return;
      const known = this.look.comparisons.map(({ name }) => name);
      this.compare(this.compared ? "" : known.includes(this.last) ? this.last : known[0]);
    },
  },
};
