"""Questions about robots in formation: what a study's Dataset says of estimators, plants and readings.

Comes in: what is concluded from trials; how they are run is `study`'s.
"""
