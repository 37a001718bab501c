"""What three.js shows of a baked GLB: the colours that were baked, pixel by pixel.

It needs Chromium and ``npm install three``, see `node_packages`; else these tests are skipped.
"""

from __future__ import annotations

import base64
import threading
import warnings
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from node_packages import node_package
from textured_shapes import globe, picture

import meshdepict as md
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.io import read_mesh
from meshdepict.io.textured import write_textured
from meshdepict.scene.view import View
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.textures import Texture

pytestmark = pytest.mark.browser

SIDE = 240
PAGE = """<!doctype html><meta charset="utf-8"><title>three.js</title>
<link rel="icon" href="data:,">
<script type="importmap">{"imports": {"three": "./three/build/three.module.js",
  "three/addons/": "./three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

window.show = async (name, side, eye, focus, up, half) => {
  const loaded = await new GLTFLoader().loadAsync(name);
  const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  renderer.setSize(side, side);
  renderer.setClearColor(0x0000ff, 1);
  const camera = new THREE.OrthographicCamera(-half, half, half, -half, -1000, 1000);
  camera.position.set(...eye);
  camera.up.set(...up);
  camera.lookAt(...focus);
  renderer.render(loaded.scene, camera);
  const gl = renderer.getContext(), bytes = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return [btoa(text), loaded.scenes.map((scene) => scene.name)];
};
</script>"""


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture
def shown(tab, tmp_path):  # noqa: F811
    """Shows a file with three.js: a picture (side, side, 3), and the names of its scenes."""
    (tmp_path / "three").symlink_to(node_package("three"))
    (tmp_path / "index.html").write_text(PAGE)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path)))
    worker = threading.Thread(target=server.serve_forever)
    worker.start()

    def show(path, view):
        tab.open(f"http://127.0.0.1:{server.server_port}/index.html")
        tab.wait("!!window.show")
        places = ", ".join(str(list(map(float, v))) for v in (view.position, view.focus, view.up))
        text, scenes = tab.js(f"show('{path.name}', {SIDE}, {places}, {view.parallel_scale})")
        assert tab.errors == []
        pixels = np.frombuffer(base64.b64decode(text), np.uint8).reshape(SIDE, SIDE, 4)
        return pixels[::-1, :, :3], scenes

    yield show
    tab.open("about:blank")  # whose connections are closed
    server.shutdown()
    worker.join()
    server.server_close()


def inner(mask):
    """Pixels whose neighbours show the surface too: rims are rounded one way or the other."""
    padded = np.pad(mask, 1)
    return mask & padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]


def agrees(picture, buffer, colors):
    """All pixels within the outline are what was expected, within two grey levels."""
    used = inner(buffer.mask)
    assert used.sum() > SIDE * SIDE / 3
    wanted = buffer.image(colors)[used]
    assert np.ptp(wanted) > 100
    assert np.abs(picture[used].astype(float) - wanted).max() <= 2


def textured_glb(path):
    """A textured ball as a glTF file of one scene."""
    checks = np.indices((32, 32)).sum(axis=0)[..., None] // 8 % 2 * [90, 60, 30] + [120, 90, 60]
    ball = globe(16, margin=0.06, base=picture(checks))
    write_textured(path, ball)
    return read_mesh(path)


@pytest.mark.parametrize(("atlas", "size"), [("own", 400), ("new", 1024)])
@pytest.mark.parametrize("beside", [False, True])
def test_textures_are_shown_as_they_were_baked(shown, tmp_path, atlas, size, beside):
    """Between texels a viewer mixes linear light: so does what is expected.

    From near by, where it takes no mipmap, and with no edge along the pixels' middles: there either
    triangle may be shown.
    """
    ball = textured_glb(tmp_path / "ball.glb") if beside else globe(16, margin=0.06)
    baked = md.bake_texture(
        ball, "half_lambert", size=size, atlas=atlas, light="northwest", colormap="viridis"
    )
    near = View((0.31, 0.17, 4), (0.013, 0.007, 0), (0, 1, 0), parallel_scale=0.6)
    buffer = GBuffer.of(ball, near, size=(SIDE, SIDE))
    picture, scenes = shown(baked.save(tmp_path / "baked.glb"), buffer.view)
    assert scenes == (["original", "depiction"] if beside else [""])
    texture = Texture("baked", None)
    linear = srgb_to_linear(baked.image / np.float32(255))
    vars(texture)["pixels"] = np.rint(65535 * linear).astype(np.uint16)
    places = baked.texcoords[buffer.triangle]
    at = np.einsum("nc,ncx->nx", buffer.barycentric, places)
    agrees(picture, buffer, 255 * linear_to_srgb(texture.lookup(at)))


@pytest.mark.parametrize("beside", [False, True])
def test_colours_of_vertices_are_shown_as_they_were_baked(shown, tmp_path, beside):
    ball = textured_glb(tmp_path / "ball.glb") if beside else globe(16)
    baked = md.bake(ball, "lambert", light="northwest", colormap="viridis", view="front")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about the texture that is kept beside
        baked.save(tmp_path / "baked.glb")
    buffer = GBuffer.of(ball, "front", size=(SIDE, SIDE))
    picture, scenes = shown(tmp_path / "baked.glb", buffer.view)
    assert scenes == (["original", "depiction"] if beside else [""])
    linear = srgb_to_linear(baked.colors / np.float32(255))
    agrees(picture, buffer, 255 * linear_to_srgb(buffer.sample(linear)))
