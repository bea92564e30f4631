"""How gains are designed: the vehicle and its laws in CasADi, and the solver that tunes them.

Comes in: CasADi, which nothing that runs a robot needs; the laws, gains and the vehicle of `controllers`.
"""
