/* How a mesh looks: colours at its vertices, or pictures on its triangles, shown as they are.
   Undoes `packed_appearance.pack_appearance`. */
"use strict";

window.Appearance = (() => {
  const VERTEX = `#version 300 es
    in vec3 position;
    in vec3 color;
    in vec2 place;
    uniform mat4 sight;
    out vec3 shade;
    out vec2 at;
    centroid out vec2 within; // of the triangle: no filter reads what lies beside it
    void main() {
      shade = color;
      at = within = place;
      gl_Position = sight * vec4(position, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 shade;
    in vec2 at;
    centroid in vec2 within;
    uniform sampler2D picture;
    uniform vec3 factor;
    uniform bool mipmaps, product;
    out vec4 seen;
    vec3 linear(vec3 c) {
      return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
    }
    vec3 shown(vec3 c) {
      return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
    }
    void main() {
      vec3 laid = texture(picture, mipmaps ? at : within).rgb;
      if (product) laid = shown(clamp(linear(laid) * factor * linear(shade), 0.0, 1.0));
      else laid *= shade; // one of them is white
      seen = vec4(laid, 1.0);
    }`;
  const PLACES = ["position", "color", "place"];

  /* Undo the differences from row to row, or from number to number. */
  function summed(numbers, stride) {
    for (let i = stride; i < numbers.length; i++) numbers[i] += numbers[i - stride];
    return numbers;
  }

  /* What draws all appearances on a canvas. */
  class Painter {
    constructor(gl) {
      const program = gl.createProgram();
      for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
      }
      PLACES.forEach((name, i) => gl.bindAttribLocation(program, i, name));
      gl.linkProgram(program);
      gl.useProgram(program);
      this.gl = gl;
      this.uniforms = Object.fromEntries(["sight", "factor", "mipmaps", "product"]
        .map((name) => [name, gl.getUniformLocation(program, name)]));
      this.white = this.texture({ wrap: ["clamp", "clamp"] }, new ImageData(
        new Uint8ClampedArray([255, 255, 255, 255]), 1, 1));
    }

    /* Look from a place: a matrix, column by column. */
    look(matrix) {
      this.gl.uniformMatrix4fv(this.uniforms.sight, false, matrix);
    }

    texture({ wrap, mipmaps }, image) {
      const { gl } = this;
      const made = gl.createTexture();
      const ways = { repeat: gl.REPEAT, clamp: gl.CLAMP_TO_EDGE, mirror: gl.MIRRORED_REPEAT };
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, gl.RGB, gl.UNSIGNED_BYTE, image);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, ways[wrap[0]]);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, ways[wrap[1]]);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER,
        mipmaps ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
      if (mipmaps) gl.generateMipmap(gl.TEXTURE_2D);
      return made;
    }

    buffer(target, data) {
      const made = this.gl.createBuffer();
      this.gl.bindBuffer(target, made);
      this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
      return made;
    }
  }

  class Appearance {
    /* `parts`: what is drawn with one picture each; `pictures`: Blobs. `load`, or
       `place` where there are none, comes before all else. */
    constructor(parts, pictures = []) {
      this.parts = parts;
      this.pictures = pictures;
      this.note = "";
    }

    /* Three bytes a vertex of the mesh itself. */
    static painted(buffer, { positions, indices }) {
      return new Appearance([{ positions, indices, colors: new Uint8Array(buffer) }]);
    }

    static unpacked(buffer, info, mesh, pictures) {
      if (!info.parts.length) return Appearance.painted(buffer, mesh);
      let start = 0;
      const next = (Kind, count, stride) => {
        const end = start + count * Kind.BYTES_PER_ELEMENT;
        const numbers = new Kind(buffer.slice(start, end));
        start = end;
        return stride ? summed(numbers, stride) : numbers;
      };
      return new Appearance(info.parts.map((part) => {
        const source = next(Uint32Array, part.vertices, 1);
        const steps = next(Int32Array, 2 * part.vertices, 2);
        const indices = next(part.wide ? Uint32Array : Uint16Array, 3 * part.faces, 1);
        const colors = part.colors ? next(Uint8Array, 3 * part.vertices, 0) : null;
        const positions = new Uint16Array(3 * part.vertices);
        source.forEach((vertex, i) => {
          for (let k = 0; k < 3; k++) positions[3 * i + k] = mesh.positions[3 * vertex + k];
        });
        const places = Float32Array.from(steps, (step) => step / info.unit);
        return { ...part, positions, indices, colors, places };
      }), pictures);
    }

    /* All of it in one: the bytes of `PackedAppearance.whole`. */
    static received(buffer, mesh) {
      const length = new DataView(buffer).getUint32(0, true);
      const info = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
      let start = 4 + length;
      const [data, ...pictures] = info.sizes.map((size) => {
        start += size;
        return buffer.slice(start - size, start);
      });
      return Appearance.unpacked(data, info, mesh, pictures.map((each) => new Blob([each])));
    }

    /* Put all of it where the graphics card has it. */
    async load(painter) {
      const largest = painter.gl.getParameter(painter.gl.MAX_TEXTURE_SIZE);
      const images = await Promise.all(this.pictures.map((blob) => this.decoded(blob, largest)));
      this.place(painter, images);
      images.forEach((image) => image.close());
      return this;
    }

    place(painter, images = []) {
      const { gl } = painter;
      this.painter = painter;
      for (const part of this.parts) {
        part.array = gl.createVertexArray();
        gl.bindVertexArray(part.array);
        const attribute = (place, data, size, kind) => {
          if (!data) return;
          const made = painter.buffer(gl.ARRAY_BUFFER, data);
          part.buffers.push(made);
          gl.enableVertexAttribArray(place);
          gl.vertexAttribPointer(place, size, kind, kind !== gl.FLOAT, 0, 0);
        };
        part.buffers = [];
        attribute(0, part.positions, 3, gl.UNSIGNED_SHORT);
        attribute(1, part.colors, 3, gl.UNSIGNED_BYTE);
        attribute(2, part.places, 2, gl.FLOAT);
        part.buffers.push(painter.buffer(gl.ELEMENT_ARRAY_BUFFER, part.indices));
        gl.bindVertexArray(null);
        const image = images[part.picture ?? -1];
        part.texture = image ? painter.texture(part, image) : null;
      }
      return this;
    }

    async decoded(blob, largest) {
      const asIs = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
      const image = await createImageBitmap(blob, asIs);
      const across = Math.max(image.width, image.height);
      if (across <= largest) return image;
      const [width, height] = [image.width, image.height].map(
        (side) => Math.max(1, Math.round((side * largest) / across)));
      this.note = `shown with ${largest} of ${across} texels: this device takes no more`;
      image.close();
      return createImageBitmap(blob, {
        ...asIs, resizeWidth: width, resizeHeight: height, resizeQuality: "high",
      });
    }

    /* Take new colours of the same vertices. */
    paint(buffer) {
      const [part] = this.parts;
      part.colors = new Uint8Array(buffer);
      if (!this.painter) return; // it is being loaded
      const { gl } = this.painter;
      gl.bindBuffer(gl.ARRAY_BUFFER, part.buffers[1]);
      gl.bufferData(gl.ARRAY_BUFFER, part.colors, gl.DYNAMIC_DRAW);
    }

    draw() {
      const { gl, uniforms, white } = this.painter;
      for (const part of this.parts) {
        const factor = part.factor || [1, 1, 1];
        gl.bindTexture(gl.TEXTURE_2D, part.texture || white);
        gl.uniform3fv(uniforms.factor, factor);
        gl.uniform1i(uniforms.mipmaps, part.mipmaps ? 1 : 0);
        const mixed = factor.some((x) => x !== 1) || (part.places && part.colors);
        gl.uniform1i(uniforms.product, mixed ? 1 : 0);
        if (!part.colors) gl.vertexAttrib4f(1, 1, 1, 1, 1);
        gl.bindVertexArray(part.array);
        const kind = part.indices instanceof Uint32Array ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
        gl.drawElements(gl.TRIANGLES, part.indices.length, kind, 0);
      }
      gl.bindVertexArray(null);
    }

    /* It is shown no more. */
    drop() {
      if (!this.painter) return;
      const { gl } = this.painter;
      for (const part of this.parts) {
        gl.deleteVertexArray(part.array);
        part.buffers.forEach((buffer) => gl.deleteBuffer(buffer));
        gl.deleteTexture(part.texture);
      }
      this.painter = null;
    }
  }

  return Object.assign(Appearance, { Painter, summed });
})();
