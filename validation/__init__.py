"""The independent benchmark of `photorque diagnose`.

It makes recordings with injected effects that are missing in the experiment file, runs the installed
program on them without the truth, and scores the answers. Laws and instruments are implemented from the
documented equations (docs/disturbances.md, docs/physics.md); the motion is integrated by SciPy.
The only part of the program that is used is its command line.
"""
