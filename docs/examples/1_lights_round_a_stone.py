"""
Lights round a stone
====================

A scale space is smoothed once; every light after that takes milliseconds. What runs along one
light is seen under another.
"""

import matplotlib.pyplot as plt

import meshdepict as md

stone = md.samples.inscription(60_000)
space = md.scale_space(stone, scales=9)
pixels = md.GBuffer.of(stone, "front", size=(480, 260))

figure, axes = plt.subplots(3, 2, figsize=(9, 7.5), layout="constrained")
for axis, azimuth in zip(axes.flat, range(0, 360, 60), strict=True):
    values = md.shading.exaggerated(space, (azimuth, 30))
    axis.imshow(pixels.image(pixels.sample(values), background=1), cmap="gray", vmin=0, vmax=1)
    axis.set_title(f"light from {azimuth}°")
    axis.set_axis_off()
plt.show()
