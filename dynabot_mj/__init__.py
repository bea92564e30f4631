"""Formation control under limited computation and communication, with point-mass and rigid-body robots.

Importing the package imports nothing heavy; start from `dynabot_mj.scenario` and `dynabot_mj.study`.
"""

__version__ = "0.1.0"
