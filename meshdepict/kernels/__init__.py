"""Functions that numba compiles, and the machine code that is kept of them.

Loading what was compiled takes llvmlite alone, which links it: numba, half a second of imports and
set-up, is loaded where something is to be compiled. `meshdepict.threads.kernel` declares a kernel.
"""
