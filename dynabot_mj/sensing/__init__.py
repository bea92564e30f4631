"""Truth -> samples: the sensors, how wrong they are, what can go wrong with them, and logs of real ones.

Comes in: what a sensor reads. What is made of it is `perception`'s.
"""
