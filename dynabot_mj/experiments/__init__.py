"""One file per question that the studies answer."""
