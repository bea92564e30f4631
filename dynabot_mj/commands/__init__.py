"""One file per sub-command, and what they share: `parsers`, `results`, `studies`, `trials`.

Comes in: options and what is printed; results come from the rooms below, whose heavy imports wait until a command runs.
"""
