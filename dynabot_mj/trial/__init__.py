"""The one loop and its clocks: parts in, outcome out.

Comes in: what happens in a trial at an instant. Knows no configuration: `study/assembly` makes the parts.
"""
