"""
Methods side by side
====================

Four ways to show the same clay tablet under the same light. One scale space serves them all.
"""

import matplotlib.pyplot as plt

import meshdepict as md

tablet = md.samples.tablet(60_000)
pixels = md.GBuffer.of(tablet, "front", size=(420, 520))

figure, axes = plt.subplots(1, 4, figsize=(12, 4), layout="constrained")
for axis, method in zip(
    axes, ("lambert", "exaggerated", "light_alignment", "radiance_scaling"), strict=True
):
    baked = md.bake(tablet, method, light="northwest")
    colors = pixels.sample(baked.colors.astype(float)).round().astype("uint8")
    axis.imshow(pixels.image(colors, background=255))
    axis.set_title(method)
    axis.set_axis_off()
plt.show()
