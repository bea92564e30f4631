"""Truth -> samples: the sensors, how wrong they are, what can go wrong with them, and logs of real ones."""
