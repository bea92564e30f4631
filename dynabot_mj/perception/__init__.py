"""What each robot believes of itself: exactly, by surrogates, by real filters; and how wrong that is.

Comes in: implementations of `belief.Perception`, their options, the statistics of their errors.
"""
