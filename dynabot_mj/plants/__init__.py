"""The two kinds of robots behind one protocol, `plant.Plant`: point masses and bodies in MuJoCo.

Comes in: what moves: bodies, ground, local laws' place. Vehicle numbers come from the MJCF alone, by `scene`.
"""
