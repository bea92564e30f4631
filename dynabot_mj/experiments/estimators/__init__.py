"""Questions about the estimators alone: Table II and Fig. 3, consistency, faults, recorded logs, what they cost.

Comes in: what needs no formation.
"""
