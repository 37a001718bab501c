"""
A coin in several materials
===========================

Radiance Scaling enhances each term of a material by itself: the same relief in matt, glossy and
few tones, and painted like a sphere.
"""

import matplotlib.pyplot as plt

import meshdepict as md

coin = md.samples.coin(60_000)
pixels = md.GBuffer.of(coin, "front", size=(420, 420))

figure, axes = plt.subplots(1, 4, figsize=(12, 3.4), layout="constrained")
for axis, material in zip(axes, ("lambert", "phong", "toon", "lit_sphere"), strict=True):
    baked = md.bake(coin, "radiance_scaling", material=material, light="northwest")
    colors = pixels.sample(baked.colors.astype(float)).round().astype("uint8")
    axis.imshow(pixels.image(colors, background=255))
    axis.set_title(material)
    axis.set_axis_off()
plt.show()
