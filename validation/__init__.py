"""The independent benchmark of `photorque diagnose`.

It makes recordings with an injected effect that the experiment file leaves out, runs the installed
program on them without the truth, and scores the answers. Laws and instruments are written from the
documented equations (docs/disturbances.md, docs/physics.md); the motion is integrated by SciPy.
Nothing of the program is used but its command line.
"""
