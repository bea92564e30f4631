"""What each robot believes of itself: exactly, by surrogates, by real filters; and how wrong that is."""
