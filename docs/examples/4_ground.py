"""
Old fields on a river terrace
=============================

Banks of 35 cm over a valley of several metres: hillshade shows the terraces, other methods the
banks.
"""

import matplotlib.pyplot as plt

import meshdepict as md

ground = md.samples.terrain((300, 300))

figure, axes = plt.subplots(1, 4, figsize=(12, 3.4), layout="constrained")
for axis, method in zip(
    axes, ("hillshade", "exaggerated", "local_dominance", "texture_shading"), strict=True
):
    baked = md.bake(ground, method)
    axis.imshow(baked.colors.reshape(300, 300, 3))
    axis.set_title(method)
    axis.set_axis_off()
plt.show()
