"""Questions about one vehicle: how it drives, how well it follows commands, with which gains.

Comes in: what needs neither a radio nor an estimator.
"""
