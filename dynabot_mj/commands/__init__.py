"""One file per sub-command, and what they share: `parsers`, `results`, `studies`."""
