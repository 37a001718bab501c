"""
What each scale sees
====================

A scale space holds the surface's normals smoothed at widths from one to the next. Shaded plainly,
the first have every scratch, the last only the form.
"""

import matplotlib.pyplot as plt

import meshdepict as md

core = md.samples.knapped_core(60_000)
space = md.scale_space(core, scales=8)
pixels = md.GBuffer.of(core, "front", size=(360, 460))

figure, axes = plt.subplots(1, 4, figsize=(12, 4), layout="constrained")
light = md.Light((-0.5, 0.6, 0.6))
for axis, scale in zip(axes, (0, 3, 5, 8), strict=True):
    values = 0.5 + 0.5 * space.normals_at(scale) @ light.direction
    axis.imshow(pixels.image(pixels.sample(values), background=1), cmap="gray", vmin=0, vmax=1)
    axis.set_title("unsmoothed" if scale == 0 else f"width {space.widths[scale]:.2g} mm")
    axis.set_axis_off()
plt.show()
